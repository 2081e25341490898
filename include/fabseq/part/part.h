// SPDX-License-Identifier: MIT
/// \file
/// The part: which elements are to be built, and where it stands on the build plate (docs/formulation.md 1).
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/part/pieces.h"
#include "fabseq/part/shape.h"
#include "fabseq/part/substrate.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace fabseq {

/// Density read from an HDF5 dataset with axes [z][y][x] (2D [y][x]), shape equal to the domain's elements
/// reversed, times PartDescription::sampling; planes that the file lacks to that at the upper ends are empty.
struct VoxelFile {
  std::string file;  ///< absolute path
  std::string dataset = "density";
  std::optional<double> threshold;  ///< density >= threshold counts as 1; none: the grey density as it is
};

/// What the config says of the part.
struct PartDescription {
  std::variant<Shape, VoxelFile> source;
  bool keep_connected = false;  ///< drop pieces that hang in the air instead of refusing them
  bool announce = true;         ///< warn of what was dropped
  int sampling = 1;  ///< an element's density is the mean over so many points along each axis, equally spaced
  std::optional<Shape> substrate = std::nullopt;  ///< what stands from the start; not part where both are
  std::optional<Shape> clamps = std::nullopt;     ///< nodes held in place of the plate's
};

/// Densities (0 to 1) of the elements of `box`, lexicographic. Collective on `comm` for voxel files (parallel
/// read). Voxel datasets may be of any numeric type. `box` may be empty on some ranks. Throws InputError (on
/// all ranks) for a missing file or dataset, a wrong shape, or densities outside [0, 1].
template <int Dim>
std::vector<double> read_density(MPI_Comm comm, const Domain<Dim>& domain, const PartDescription& description,
                                 const IndexBox<Dim>& box);

/// What a decomposition balances: elements of part and substrate count 1, others a tenth (they are in the
/// heat problem only). `description` must outlive the function, whose calls are collective on `comm`.
template <int Dim>
ElementWeights<Dim> element_weights(MPI_Comm comm, const Domain<Dim>& domain,
                                    const PartDescription& description);

/// A grid decomposed by element_weights(). Collective on `comm`; throws what Grid and read_density throw.
template <int Dim>
Grid<Dim> make_balanced_grid(MPI_Comm comm, const Domain<Dim>& domain, const PartDescription& description);

/// The elements to be built, distributed like the grid's elements.
template <int Dim>
class Part {
 public:
  /// Collective on the grid's communicator. The grid must outlive the part. Throws InputError for an empty
  /// part, no contact with plate or substrate, or pieces without a path of faces to them (naming number, size
  /// and place), unless `description.keep_connected`, which drops them with a warning. Elements of the
  /// substrate are no part elements.
  Part(const Grid<Dim>& grid, const PartDescription& description, const BuildPlate& plate);

  const Grid<Dim>& grid() const { return grid_; }
  const BuildPlate& plate() const { return plate_; }
  const Substrate<Dim>& substrate() const { return substrate_; }

  /// Density of every owned element of the grid, lexicographic.
  const std::vector<double>& density() const { return density_; }
  /// Owned part elements (density > 0): offsets in Grid::owned_elements(), ascending. "Part fields" have one
  /// entry per part element.
  const std::vector<int>& elements() const { return elements_; }
  /// Density of each part element (a part field).
  const std::vector<double>& part_density() const { return part_density_; }
  /// Offset in the ghosted node box of each part element's lowest node (a part field).
  const std::vector<int>& first_corners() const { return first_corners_; }
  /// Part elements of all ranks.
  std::int64_t count() const { return count_; }
  /// V* of docs/formulation.md 7: volume weighted by density, all ranks.
  double volume() const { return volume_; }
  /// Corners of the bounding box of all part elements.
  const Point<Dim>& lower() const { return lower_; }
  const Point<Dim>& upper() const { return upper_; }
  /// Longest edge of the bounding box: the default characteristic length.
  double longest_edge() const;
  /// The pieces, largest first, before any were dropped.
  const std::vector<Piece<Dim>>& pieces() const { return pieces_; }
  /// Part elements with a face on the build plate or on the substrate, all ranks.
  std::int64_t plate_contact() const { return plate_contact_; }
  /// For each part element, half the spacing across its face on the plate or on the substrate, the smallest
  /// one; infinite without such a face (a part field).
  const std::vector<double>& contact_distance() const { return contact_distance_; }

  /// Owned nodes of at least one part element (1 or 0), lexicographic in Grid::owned_nodes().
  const std::vector<char>& touched_nodes() const { return touched_nodes_; }
  /// Whether a node lies on the plate's face of the box.
  bool on_plate(const Index<Dim>& node) const {
    return node[plate_.axis] == (plate_.upper ? grid_.domain().elements[plate_.axis] : 0);
  }

  /// Values of a part field on all owned elements of the grid, `outside` where there is no part.
  std::vector<double> expand(std::span<const double> part_field, double outside = 0.0) const {
    std::vector<double> field(density_.size(), outside);
    for (std::size_t i = 0; i < elements_.size(); ++i) field[elements_[i]] = part_field[i];
    return field;
  }
  /// The part elements' values of a field on all owned elements.
  std::vector<double> restrict_to_part(std::span<const double> element_field) const {
    std::vector<double> field(elements_.size());
    for (std::size_t i = 0; i < elements_.size(); ++i) field[i] = element_field[elements_[i]];
    return field;
  }

 private:
  void refuse_empty_part(const PartDescription& description) const;
  void refuse_no_contact() const;
  void drop_or_refuse_hanging_pieces(const PartDescription& description);
  void collect_elements(const std::vector<double>& distance_to_substrate);
  void measure_extent();

  const Grid<Dim>& grid_;
  BuildPlate plate_;
  Substrate<Dim> substrate_;
  std::vector<double> density_, part_density_, contact_distance_;
  std::vector<int> elements_, first_corners_;
  std::vector<int> piece_of_element_;  ///< index into pieces_ for each owned element, -1 outside the part
  std::int64_t count_ = 0, plate_contact_ = 0;
  double volume_ = 0.0;
  Point<Dim> lower_{}, upper_{};
  std::vector<Piece<Dim>> pieces_;
  std::vector<char> touched_nodes_;
};

}  // namespace fabseq
