// SPDX-License-Identifier: MIT
/// \file
/// The part: which elements are to be built, and where it stands on the build plate (docs/formulation.md 1).
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/grid/grid.h"
#include "fabseq/part/mesh_part.h"
#include "fabseq/part/pieces.h"
#include "fabseq/part/shape.h"
#include "fabseq/part/substrate.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace fabseq {

/// Density from an HDF5 dataset with axes [z][y][x] (2D [y][x]). Its shape is that of the domain's elements
/// reversed, times PartDescription::sampling. The file may have up to `sampling` - 1 planes fewer at the
/// upper end of an axis; the missing ones are empty.
struct VoxelFile {
  std::string file;  ///< absolute path
  std::string dataset = "density";
  /// Densities >= threshold count as 1, all others as 0. None: densities are taken as they are.
  std::optional<double> threshold;
  int repeat = 1;  ///< each value stands for so many along each axis: the domain is as many times finer
};

/// The part as the config describes it.
struct PartDescription {
  std::variant<Shape, VoxelFile, MeshFile> source;
  bool keep_connected = false;  ///< drop pieces that hang in the air instead of refusing the part
  bool announce = true;         ///< warn of dropped pieces
  /// Density of an element: mean over this number of equally spaced points along each axis.
  int sampling = 1;
  /// What stands from the start. Elements in both shapes belong to the substrate, not to the part.
  std::optional<Shape> substrate = std::nullopt;
  std::optional<Shape> stock = std::nullopt;  ///< elements in it belong to the part, too: to be machined away
  std::optional<Shape> clamps = std::nullopt;  ///< nodes in it are held instead of the plate's
  /// What a MeshFile holds, which must be there before densities are asked for.
  std::shared_ptr<const PlacedMesh> mesh = nullptr;
};

/// Densities (0 to 1) of the elements of `box`, lexicographic. Voxel datasets may have any numeric type.
/// `box` may be empty on some ranks. Collective on `comm` for voxel files (parallel read). Throws InputError
/// on all ranks for a missing file or dataset, a wrong shape, or densities outside [0, 1]. `clarity` is set
/// to how clearly a mesh says what lies inside it, on this rank.
template <int Dim>
std::vector<double> read_density(MPI_Comm comm, const Domain<Dim>& domain, const PartDescription& description,
                                 const IndexBox<Dim>& box, Clarity* clarity = nullptr);

/// Fills the elements of `box` that lie in the description's stock. Returns by how many whole elements the
/// densities rise on this rank. Not collective.
template <int Dim>
double add_stock(const Domain<Dim>& domain, const PartDescription& description, const IndexBox<Dim>& box,
                 std::span<double> density);

/// Weights by which a decomposition is balanced: elements of part and substrate count 1, all others a tenth,
/// because they take part in the heat problem only. `description` must outlive the returned function, whose
/// calls are collective on `comm`.
template <int Dim>
ElementWeights<Dim> element_weights(MPI_Comm comm, const Domain<Dim>& domain,
                                    const PartDescription& description);

/// A grid that is decomposed by element_weights(). Collective on `comm`. Throws what Grid and read_density()
/// throw.
template <int Dim>
Grid<Dim> make_balanced_grid(MPI_Comm comm, const Domain<Dim>& domain, const PartDescription& description);

/// The elements to be built, distributed like the grid's elements.
template <int Dim>
class Part {
 public:
  /// Collective on the grid's communicator. The grid must outlive the part. Elements of the substrate are no
  /// part elements. Throws InputError for an empty part, for a part without contact with plate or substrate,
  /// and for pieces without a path of faces to them, naming their number, size and place. With
  /// `description.keep_connected`, such pieces are dropped with a warning instead.
  Part(const Grid<Dim>& grid, const PartDescription& description, const BuildPlate& plate);

  const Grid<Dim>& grid() const { return grid_; }
  const BuildPlate& plate() const { return plate_; }
  const Substrate<Dim>& substrate() const { return substrate_; }

  /// Share of the part's volume that is machining stock: that PartDescription::stock has added.
  double share_of_stock() const { return share_of_stock_; }
  /// What the part comes from, if that is a mesh; else null.
  const PlacedMesh* mesh() const { return mesh_.get(); }
  /// Volume of the elements that the mesh fills, substrate and dropped pieces included, over the volume
  /// inside the mesh; 1 if the part comes from no mesh.
  double share_of_mesh() const { return share_of_mesh_; }

  /// Density of every owned element of the grid, lexicographic.
  const std::vector<double>& density() const { return density_; }
  /// 1 on the owned elements of part and substrate, 0 on others; lexicographic.
  std::vector<double> solid() const { return expand(std::vector<double>(elements_.size(), 1.0), 0.0, 1.0); }
  /// Owned part elements (density > 0) as offsets in Grid::owned_elements(), ascending. A "part field" has
  /// one entry per entry of elements().
  const std::vector<int>& elements() const { return elements_; }
  /// Density of each part element (a part field).
  const std::vector<double>& part_density() const { return part_density_; }
  /// Offset in the ghosted node box of each part element's lowest node (a part field).
  const std::vector<int>& first_corners() const { return first_corners_; }
  /// Number of part elements, summed over all ranks.
  std::int64_t count() const { return count_; }
  /// Volume weighted by density, summed over all ranks: V* of docs/formulation.md 7.
  double volume() const { return volume_; }
  /// Corners of the bounding box of all part elements, on all ranks; length unit.
  const Point<Dim>& lower() const { return lower_; }
  const Point<Dim>& upper() const { return upper_; }
  /// Longest edge of the bounding box, length unit. It is the default characteristic length.
  double longest_edge() const;
  /// All pieces, largest first, including those that were dropped. The same on all ranks.
  const std::vector<Piece<Dim>>& pieces() const { return pieces_; }
  /// Number of part elements with a face on the build plate or on the substrate, summed over all ranks.
  std::int64_t plate_contact() const { return plate_contact_; }
  /// Half the spacing across each part element's face on the plate or on the substrate, the smallest one if
  /// there are several; infinite without such a face. A part field in length units.
  const std::vector<double>& contact_distance() const { return contact_distance_; }

  /// 1 for owned nodes of at least one part element, on any rank, 0 for others; lexicographic in
  /// Grid::owned_nodes().
  const std::vector<char>& touched_nodes() const { return touched_nodes_; }
  /// Whether a node lies on the plate's face of the box.
  bool on_plate(const Index<Dim>& node) const {
    return node[plate_.axis] == (plate_.upper ? grid_.domain().elements[plate_.axis] : 0);
  }

  /// Values of a part field on all owned elements of the grid, `outside` for elements outside the part.
  std::vector<double> expand(std::span<const double> part_field, double outside = 0.0) const {
    std::vector<double> field(density_.size(), outside);
    for (std::size_t i = 0; i < elements_.size(); ++i) field[elements_[i]] = part_field[i];
    return field;
  }
  /// The same with another value for elements of the substrate.
  std::vector<double> expand(std::span<const double> part_field, double outside, double on_substrate) const {
    std::vector<double> field = expand(part_field, outside);
    for (std::size_t element = 0; element < field.size(); ++element)
      if (substrate_.elements()[element] != 0) field[element] = on_substrate;
    return field;
  }
  /// Part field of the values that a field on all owned elements has in the part.
  std::vector<double> restrict_to_part(std::span<const double> element_field) const {
    std::vector<double> field(elements_.size());
    for (std::size_t i = 0; i < elements_.size(); ++i) field[i] = element_field[elements_[i]];
    return field;
  }
  /// Centre of the element that comes first in the grid, among the part elements of all ranks that `chosen`
  /// names: chosen(index in a part field). There must be one. Collective on the grid's communicator.
  template <class Chosen>
  Point<Dim> first_place(const Chosen& chosen) const {
    const IndexBox<Dim> whole = grid_.all_elements();
    std::int64_t place = whole.count();
    for (std::size_t e = 0; e < elements_.size(); ++e)
      if (chosen(e)) place = std::min(place, whole.offset(grid_.owned_elements().index(elements_[e])));
    return grid_.element_center(whole.index(min(grid_.comm(), place)));
  }

 private:
  void measure_share_of_mesh();
  void warn_about(const Clarity& clarity) const;
  /// Share of the mesh's volume in the grid's box, 1 without a mesh. Warns of what is cut off; throws
  /// InputError if that is more than half.
  double share_of_mesh_in_box() const;
  void warn_about_volume(double share_in_box) const;
  void refuse_empty_part(const PartDescription& description) const;
  void refuse_no_contact() const;
  void drop_or_refuse_hanging_pieces(const PartDescription& description,
                                     const std::vector<int>& piece_of_element);
  void collect_elements(const std::vector<double>& distance_to_substrate);
  void measure_extent();

  const Grid<Dim>& grid_;
  BuildPlate plate_;
  Substrate<Dim> substrate_;
  std::shared_ptr<const PlacedMesh> mesh_;
  double share_of_mesh_ = 1.0, share_of_stock_ = 0.0;
  std::vector<double> density_, part_density_, contact_distance_;
  std::vector<int> elements_, first_corners_;
  std::int64_t count_ = 0, plate_contact_ = 0;
  double volume_ = 0.0;
  Point<Dim> lower_{}, upper_{};
  std::vector<Piece<Dim>> pieces_;
  std::vector<char> touched_nodes_;
};

}  // namespace fabseq
