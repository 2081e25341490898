// SPDX-License-Identifier: MIT
#include "fabseq/part/part.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace fabseq {

namespace {

/// "14 elements in [0.1,0,0.5]..[0.3,0.2,0.9]"
template <int Dim>
std::string piece_text(const Piece<Dim>& piece) {
  return std::to_string(piece.elements) + (piece.elements == 1 ? " element in " : " elements in ") +
         to_text<Dim>(piece.min) + ".." + to_text<Dim>(piece.max);
}

template <int Dim>
void require_plate(const BuildPlate& plate) {
  if (plate.axis < 0 || plate.axis >= Dim)
    throw InputError("/build_plate: axis " + std::to_string(plate.axis) + " in " + std::to_string(Dim) +
                     " dimensions, needs a face of the domain");
}

}  // namespace

template <int Dim>
Part<Dim>::Part(const Grid<Dim>& grid, const PartDescription& description, const BuildPlate& plate)
    : grid_(grid), plate_(plate), substrate_(grid, description.substrate), mesh_(description.mesh) {
  require_plate<Dim>(plate);
  Clarity clarity;
  density_ = read_density<Dim>(grid.comm(), grid.domain(), description, grid.owned_elements(), &clarity);
  if (mesh_) measure_share_of_mesh();
  if (mesh_ && description.announce) warn_about(clarity);
  const double stock = add_stock<Dim>(grid.domain(), description, grid.owned_elements(), density_);
  for (std::size_t e = 0; e < density_.size(); ++e)
    if (substrate_.elements()[e] != 0) density_[e] = 0.0;
  refuse_empty_part(description);
  if (description.announce) warn_about_volume(share_of_mesh_in_box());
  const std::vector<double> distance = substrate_.contact_distance();
  PieceMap<Dim> map = find_pieces<Dim>(grid, density_, plate, distance);
  pieces_ = std::move(map.pieces);
  refuse_no_contact();
  drop_or_refuse_hanging_pieces(description, map.piece_of_element);
  collect_elements(distance);
  measure_extent();
  share_of_stock_ = sum(grid.comm(), stock) * grid.element_volume() / volume_;
  touched_nodes_ = nodes_of_elements(grid, elements_);
}

template <int Dim>
void Part<Dim>::measure_share_of_mesh() {
  double volume = sum(grid_.comm(), std::accumulate(density_.begin(), density_.end(), 0.0));
  for (int axis = 0; axis < Dim; ++axis) volume *= grid_.domain().size[axis] / grid_.domain().elements[axis];
  share_of_mesh_ = volume / mesh_->volume();
}

template <int Dim>
double Part<Dim>::share_of_mesh_in_box() const {
  constexpr double allowed = 0.5, tolerated = 0.01, rounding = 1e-3;
  double share = 1.0;
  if constexpr (Dim == 3)
    if (mesh_) share = mesh_->share_within(grid_.comm(), grid_.domain());
  const double cut_off = 1.0 - share;
  if (cut_off <= tolerated) return share;
  const std::string message =
      formatted("/domain: %.3g %% of the mesh's volume lies outside the box ", 100.0 * cut_off) +
      to_text<Dim>(grid_.domain().origin) + ".." +
      to_text<Dim>(grid_.node_position(grid_.domain().elements)) + "; the mesh lies in " +
      to_text<3>(mesh_->lower()) + ".." + to_text<3>(mesh_->upper());
  if (cut_off > allowed + rounding)
    throw InputError(message + formatted("; allowed: up to %g %%", 100.0 * allowed));
  warn(message + "; it is cut off");
  return share;
}

template <int Dim>
void Part<Dim>::warn_about_volume(double share_in_box) const {
  constexpr double tolerated = 0.03;
  const double share = share_of_mesh_ / share_in_box;
  if (std::abs(share - 1.0) <= tolerated) return;
  warn(formatted(
      "/domain: the part's elements have %.4g times the volume of the mesh%s, which differs by more than "
      "%g %%: smaller elements come nearer",
      share, share_in_box < 1.0 ? " in the box" : "", 100.0 * tolerated));
}

template <int Dim>
void Part<Dim>::warn_about(const Clarity& clarity) const {
  const std::int64_t asked = sum(grid_.comm(), clarity.asked), unclear = sum(grid_.comm(), clarity.unclear);
  if (unclear == 0) return;
  // The point whose winding number is nearest to 1/2 in modulus: of the first rank that has it.
  const double doubt = clarity.asked > 0 ? std::abs(std::abs(clarity.least_winding) - 0.5) : 1.0;
  const double most = min(grid_.comm(), doubt);
  const int first = static_cast<int>(
      min(grid_.comm(), std::int64_t{doubt == most ? rank_of(grid_.comm()) : size_of(grid_.comm())}));
  Point<3> place = clarity.least_clear;
  broadcast(grid_.comm(), place, first);
  warn("/part/mesh: the mesh has holes, or faces that are turned round: inside is not clear for " +
       formatted("%.3g %% of %lld points, least at ",
                 100.0 * static_cast<double>(unclear) / static_cast<double>(asked),
                 static_cast<long long>(asked)) +
       to_text<3>(place));
}

template <int Dim>
void Part<Dim>::refuse_empty_part(const PartDescription& description) const {
  const bool here = std::any_of(density_.begin(), density_.end(), [](double value) { return value > 0.0; });
  if (any(grid_.comm(), here)) return;
  std::string message = "/part: no element has a density above 0";
  const std::string low = to_text<Dim>(grid_.domain().origin),
                    high = to_text<Dim>(grid_.node_position(grid_.domain().elements));
  if (const auto* voxels = std::get_if<VoxelFile>(&description.source))
    message += " in dataset '" + voxels->dataset + "' of '" + voxels->file + "'" +
               (voxels->threshold ? " with this threshold" : "");
  else if (mesh_)
    message += ": no element between " + low + " and " + high +
               " is filled by the mesh, which lies between " + to_text<3>(mesh_->lower()) + " and " +
               to_text<3>(mesh_->upper());
  else
    message += ": no element's centre in the domain " + low + ".." + high + " lies inside the shape";
  if (substrate_.count() > 0) message += " and outside the substrate";
  throw InputError(message + "; needs at least one");
}

template <int Dim>
void Part<Dim>::refuse_no_contact() const {
  if (std::any_of(pieces_.begin(), pieces_.end(),
                  [](const Piece<Dim>& piece) { return piece.touches_plate; }))
    return;
  const int axis = plate_.axis;
  const bool upper = plate_.upper;
  const auto nearer = [&](const Piece<Dim>& a, const Piece<Dim>& b) {
    return upper ? a.max[axis] > b.max[axis] : a.min[axis] < b.min[axis];
  };
  const Piece<Dim>& nearest = *std::min_element(pieces_.begin(), pieces_.end(), nearer);
  const char* or_substrate = substrate_.count() > 0 ? " or on the substrate" : "";
  throw InputError("/build_plate: no element of the part has a face on the build plate " + plate_.name() +
                   or_substrate + "; nearest: " + piece_text<Dim>(nearest) +
                   ", needs contact with that face of the domain" + or_substrate);
}

template <int Dim>
void Part<Dim>::drop_or_refuse_hanging_pieces(const PartDescription& description,
                                              const std::vector<int>& piece_of_element) {
  constexpr int listed = 5;
  int hanging = 0;
  std::string list;
  for (const Piece<Dim>& piece : pieces_)
    if (!piece.touches_plate && hanging++ < listed)
      list += (list.empty() ? "" : ", ") + piece_text<Dim>(piece);
  if (hanging == 0) return;
  if (hanging > listed) list += ", and " + std::to_string(hanging - listed) + " more";
  const std::string message =
      "/part: " + std::to_string(hanging) + (hanging == 1 ? " piece is" : " pieces are") +
      " not connected to the build plate" + (substrate_.count() > 0 ? " or the substrate: " : ": ") + list;
  if (!description.keep_connected)
    throw InputError(message + "; set part.keep to \"connected\" to drop " + (hanging == 1 ? "it" : "them"));
  if (description.announce) warn(message + "; dropped");
  for (std::size_t e = 0; e < density_.size(); ++e)
    if (piece_of_element[e] >= 0 && !pieces_[piece_of_element[e]].touches_plate) density_[e] = 0.0;
}

template <int Dim>
void Part<Dim>::collect_elements(const std::vector<double>& distance_to_substrate) {
  const IndexBox<Dim>& box = grid_.owned_elements();
  double volume = 0.0;
  std::int64_t contact = 0;
  box.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    const double density = density_[offset];
    if (!(density > 0.0)) return;
    elements_.push_back(static_cast<int>(offset));
    part_density_.push_back(density);
    first_corners_.push_back(grid_.first_corner(element));
    volume += density;
    double distance = distance_to_substrate[offset];
    if (plate_.touches<Dim>(element, grid_.domain().elements))
      distance = std::min(distance, 0.5 * grid_.spacing()[plate_.axis]);
    contact_distance_.push_back(distance);
    if (std::isfinite(distance)) ++contact;
  });
  count_ = sum(grid_.comm(), static_cast<std::int64_t>(elements_.size()));
  plate_contact_ = sum(grid_.comm(), contact);
  volume_ = sum(grid_.comm(), volume) * grid_.element_volume();
}

template <int Dim>
void Part<Dim>::measure_extent() {
  // Only the pieces that were kept count; their boxes consist of whole elements.
  lower_.fill(std::numeric_limits<double>::infinity());
  upper_.fill(-std::numeric_limits<double>::infinity());
  for (const Piece<Dim>& piece : pieces_) {
    if (!piece.touches_plate) continue;
    for (int axis = 0; axis < Dim; ++axis) {
      lower_[axis] = std::min(lower_[axis], piece.min[axis]);
      upper_[axis] = std::max(upper_[axis], piece.max[axis]);
    }
  }
}

template <int Dim>
double Part<Dim>::longest_edge() const {
  double longest = 0.0;
  for (int axis = 0; axis < Dim; ++axis) longest = std::max(longest, upper_[axis] - lower_[axis]);
  return longest;
}

FABSEQ_INSTANTIATE_CLASS(Part);

}  // namespace fabseq
