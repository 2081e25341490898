// SPDX-License-Identifier: MIT
#include "fabseq/part/mesh_part.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/refusal.h"
#include "fabseq/mesh/read_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace fabseq {

namespace {

using Matrix = std::array<Point<3>, 3>;

/// Meshes that enclose a smaller share of their bounding box count as without volume.
constexpr double least_share_of_box = 1e-6;
/// Samples of a closed body find its volume within this share if so many elements are filled; where they do
/// not, bodies overlap.
constexpr double sampled_accuracy = 0.05;
constexpr int sampled_elements = 32;  // along each axis
constexpr double least_share = 64.0 / (sampled_elements * sampled_elements * sampled_elements);

double volume_between(const Point<3>& low, const Point<3>& high) {
  return (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
}

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix result{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) result[i][j] += a[i][k] * b[k][j];
  return result;
}

/// Sines and cosines of quarter turns are exact, so that faces stay on the planes of the grid.
std::array<double, 2> sine_and_cosine(double degrees) {
  const double quarters = degrees / 90.0;
  if (quarters != std::floor(quarters)) {
    const double angle = degrees * std::numbers::pi / 180.0;
    return {std::sin(angle), std::cos(angle)};
  }
  const auto quarter = static_cast<int>(std::fmod(std::fmod(quarters, 4.0) + 4.0, 4.0));
  constexpr std::array<std::array<double, 2>, 4> exact = {{{0, 1}, {1, 0}, {0, -1}, {-1, 0}}};
  return exact[quarter];
}

/// Rodrigues' formula.
Matrix rotation(const Turn& turn) {
  const auto [sine, cosine] = sine_and_cosine(turn.degrees);
  const double length = std::hypot(turn.axis[0], turn.axis[1], turn.axis[2]);
  Point<3> n;
  for (int i = 0; i < 3; ++i) n[i] = turn.axis[i] / length;
  const Matrix across = {{{0, -n[2], n[1]}, {n[2], 0, -n[0]}, {-n[1], n[0], 0}}};
  Matrix result{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      result[i][j] = (i == j ? cosine : 0.0) + sine * across[i][j] + (1.0 - cosine) * n[i] * n[j];
  return result;
}

Matrix scaled_rotation(const MeshFile& description) {
  Matrix result{};
  for (int i = 0; i < 3; ++i) result[i][i] = description.scale;
  for (const Turn& turn : description.turns) result = product(rotation(turn), result);
  return result;
}

/// The planes z = constant of a box that are this rank's when all ranks share them.
IndexBox<3> own_planes(MPI_Comm comm, const Index<3>& elements) {
  const std::int64_t ranks = size_of(comm), rank = rank_of(comm), planes = elements[2];
  const auto begin = static_cast<int>(planes * rank / ranks),
             end = static_cast<int>(planes * (rank + 1) / ranks);
  return {{0, 0, begin}, {elements[0], elements[1], end - begin}};
}

}  // namespace

PlacedSurface read_placed_surface(MPI_Comm comm, const MeshFile& description, const BuildPlate& plate,
                                  const std::string& unit) {
  PlacedSurface result;
  result.matrix = scaled_rotation(description);
  ReadMesh read = read_body(comm, description.file, "/part/mesh/file", unit);
  result.unit_factor = read.unit_factor;
  if (!description.as_is) {
    const Bounds turned = bounds(transformed(read.mesh, result.matrix, {}));
    result.shift[plate.axis] = -(plate.upper ? turned.high : turned.low)[plate.axis];
  }
  result.mesh = transformed(std::move(read.mesh), result.matrix, result.shift);
  const auto [low, high] = bounds(result.mesh);
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::max(-low[axis], high[axis]) <= largest_mesh_coordinate))
      refuse("/part/mesh/scale", formatted("%g", description.scale),
             formatted("one that leaves the mesh's coordinates below %g", largest_mesh_coordinate));
  return result;
}

PlacedMesh::PlacedMesh(MPI_Comm comm, const MeshFile& description, const BuildPlate& plate,
                       const std::string& unit)
    : surface_(read_placed_surface(comm, description, plate, unit)),
      bounds_(bounds(surface_.mesh)),
      unit_(unit) {
  interior_.emplace(surface_.mesh);
  const double volume_of_box = volume_between(lower(), upper());
  if (volume_of_box > 0.0) volume_ = measured_volume(comm);
  if (!(volume_of_box > 0.0) || (interior_->closed() && volume_ < least_share_of_box * volume_of_box))
    throw InputError("/part/mesh/file: '" + description.file + "' encloses no volume between " +
                     to_text<3>(lower()) + " and " + to_text<3>(upper()) +
                     "; allowed: the surface of a body in space");
}

TriangleMesh PlacedMesh::placed(TriangleMesh mesh) const {
  return transformed(std::move(mesh), surface_.matrix, surface_.shift);
}

std::array<std::array<double, 4>, 3> PlacedMesh::placement() const {
  std::array<std::array<double, 4>, 3> result;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) result[i][k] = surface_.matrix[i][k] * surface_.unit_factor;
    result[i][3] = surface_.shift[i];
  }
  return result;
}

FillFractions PlacedMesh::fill(const Domain<3>& domain, const IndexBox<3>& box) const {
  ElementLattice lattice{domain.origin, {}};
  for (int axis = 0; axis < 3; ++axis) lattice.spacing[axis] = domain.size[axis] / domain.elements[axis];
  return interior_->fill_fractions(lattice, box);
}

std::int64_t PlacedMesh::count_filled(MPI_Comm comm, const Domain<3>& domain, double least) const {
  const std::vector<double> shares = fill(domain, own_planes(comm, domain.elements)).of_element;
  return sum(comm, static_cast<std::int64_t>(std::count_if(
                       shares.begin(), shares.end(), [least](double share) { return share >= least; })));
}

double PlacedMesh::sampled_share(MPI_Comm comm, const Point<3>& low, const Point<3>& high) const {
  Domain<3> box;
  box.origin = low;
  for (int axis = 0; axis < 3; ++axis) {
    box.elements[axis] = sampled_elements;
    box.size[axis] = high[axis] - low[axis];
  }
  const std::vector<double> shares = fill(box, own_planes(comm, box.elements)).of_element;
  const double filled = sum(comm, std::accumulate(shares.begin(), shares.end(), 0.0));
  return filled / (sampled_elements * sampled_elements * sampled_elements);
}

double PlacedMesh::measured_volume(MPI_Comm comm) const {
  const double share = sampled_share(comm, lower(), upper());
  const double sampled = share * volume_between(lower(), upper()),
               enclosed = std::abs(signed_volume(surface_.mesh));
  const bool trusted = share < least_share ||
                       (interior_->closed() && std::abs(enclosed - sampled) <= sampled_accuracy * enclosed);
  return trusted ? enclosed : sampled;
}

double PlacedMesh::share_within(MPI_Comm comm, const Domain<3>& domain) const {
  constexpr double rounding = 1e-4;  // of an edge of the mesh
  Point<3> low, high;
  bool holds_all = true;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(lower()[axis], domain.origin[axis]);
    high[axis] = std::min(upper()[axis], domain.origin[axis] + domain.size[axis]);
    if (high[axis] <= low[axis]) return 0.0;
    const double cut_off = low[axis] - lower()[axis] + upper()[axis] - high[axis];
    holds_all = holds_all && cut_off <= rounding * (upper()[axis] - lower()[axis]);
  }
  if (holds_all) return 1.0;
  const double whole = sampled_share(comm, lower(), upper()) * volume_between(lower(), upper());
  if (!(whole > 0.0)) return 1.0;  // too thin to be sampled
  return std::min(1.0, sampled_share(comm, low, high) * volume_between(low, high) / whole);
}

}  // namespace fabseq
