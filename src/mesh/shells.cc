// SPDX-License-Identifier: MIT
#include "mesh/shells.h"

#include "fabseq/mesh/winding_number.h"
#include "mesh/mesh_pieces.h"
#include "mesh/vectors.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

namespace fabseq {

namespace {

/// Closed pieces that enclose a smaller share of their box enclose nothing.
constexpr double least_share_of_box = 1e-9;

/// A winding number and the mesh to which it refers.
struct Surroundings {
  TriangleMesh mesh;
  std::unique_ptr<const WindingNumber> winding;
};

/// A closed piece that encloses a volume.
struct Shell {
  const MeshPiece* piece;
  double volume;  ///< negative if it faces inward
  Bounds box;
  std::int32_t around = -1;           ///< the smallest shell in which it lies
  int winding = 0;                    ///< number inside, once all shells are turned
  std::vector<std::int32_t> perhaps;  ///< shells in whose boxes its box lies
  Surroundings surroundings;          ///< made when first asked
};

TriangleMesh part_of(const TriangleMesh& mesh, const MeshPiece& piece) {
  TriangleMesh result;
  result.points.reserve(3 * piece.triangles.size());
  for (const std::int32_t t : piece.triangles) {
    const auto first = static_cast<std::int32_t>(result.points.size());
    for (const Point<3>& corner : mesh.corners(static_cast<std::size_t>(t))) result.points.push_back(corner);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

double signed_volume(const TriangleMesh& mesh, const MeshPiece& piece) {
  const Point<3> apex = mesh.corners(static_cast<std::size_t>(piece.triangles.front()))[0];
  double sum = 0.0;
  for (const std::int32_t t : piece.triangles) {
    const auto [a, b, c] = mesh.corners(static_cast<std::size_t>(t));
    sum += dot(difference(a, apex), cross(difference(b, apex), difference(c, apex)));
  }
  return sum / 6.0;
}

/// The shells among the pieces, the largest first.
std::vector<Shell> find_shells(const TriangleMesh& mesh, const std::vector<MeshPiece>& pieces) {
  std::vector<Shell> shells;
  for (const MeshPiece& piece : pieces) {
    if (!piece.closed) continue;
    const Bounds box = bounds(mesh, piece.triangles);
    const double enclosed = signed_volume(mesh, piece);
    if (!(std::abs(enclosed) > least_share_of_box * volume(box))) continue;
    Shell& shell = shells.emplace_back();
    shell.piece = &piece;
    shell.volume = enclosed;
    shell.box = box;
  }
  std::stable_sort(shells.begin(), shells.end(),
                   [](const Shell& a, const Shell& b) { return std::abs(a.volume) > std::abs(b.volume); });
  return shells;
}

bool lies_in(const Bounds& inner, const Bounds& outer) {
  for (int axis = 0; axis < 3; ++axis)
    if (inner.low[axis] < outer.low[axis] || inner.high[axis] > outer.high[axis]) return false;
  return true;
}

/// Notes for each shell the larger ones in whose boxes it lies, the smallest of them first. A plane sweeps
/// over the shells.
void compare_boxes(std::vector<Shell>& shells) {
  constexpr double rounding = 1e-6;  // shells of the same volume do not lie in each other
  std::vector<std::int32_t> order(shells.size()), open;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return shells[a].box.low[0] < shells[b].box.low[0];
  });
  const auto compare = [&](std::int32_t inner, std::int32_t outer) {
    if (std::abs(shells[inner].volume) < (1.0 - rounding) * std::abs(shells[outer].volume) &&
        lies_in(shells[inner].box, shells[outer].box))
      shells[inner].perhaps.push_back(outer);
  };
  for (const std::int32_t number : order) {
    std::erase_if(open,
                  [&](std::int32_t other) { return shells[other].box.high[0] < shells[number].box.low[0]; });
    for (const std::int32_t earlier : open) {
      compare(number, earlier);
      compare(earlier, number);
    }
    open.push_back(number);
  }
  for (Shell& shell : shells) std::sort(shell.perhaps.rbegin(), shell.perhaps.rend());
}

/// Whether points of a shell lie in another one or on its surface, most of them in it.
class Containment {
 public:
  explicit Containment(const TriangleMesh& mesh) : mesh_(mesh) {}

  bool lies_in(const Shell& inner, Shell& outer) const {
    constexpr double on_surface =
        0.05;  // the least winding number in a corner of a surface; far above errors
    const WindingNumber& winding = winding_of(outer);
    const std::vector<Point<3>> points = points_of(inner);
    Point<3> center;
    for (int axis = 0; axis < 3; ++axis) center[axis] = 0.5 * (inner.box.low[axis] + inner.box.high[axis]);
    const double radius = 0.5 * norm(difference(inner.box.high, inner.box.low));
    std::vector<double> values(points.size());
    double sum = 0.0;
    for (std::size_t begin = 0; begin < points.size(); begin += WindingNumber::group_limit) {
      const std::size_t count = std::min(WindingNumber::group_limit, points.size() - begin);
      const auto found = std::span(values).subspan(begin, count);
      winding.at(std::span(points).subspan(begin, count), center, radius, found);
      for (const double value : found)
        if (std::abs(value) < on_surface) return false;
      sum += std::abs(std::accumulate(found.begin(), found.end(), 0.0));
    }
    return sum > 0.5 * static_cast<double>(points.size());
  }

 private:
  const WindingNumber& winding_of(Shell& shell) const {
    Surroundings& made = shell.surroundings;
    if (!made.winding) {
      made.mesh = part_of(mesh_, *shell.piece);
      made.winding = std::make_unique<const WindingNumber>(made.mesh);
    }
    return *made.winding;
  }

  /// Corners and centroids of up to 64 triangles.
  std::vector<Point<3>> points_of(const Shell& shell) const {
    const std::vector<std::int32_t>& triangles = shell.piece->triangles;
    const std::size_t count = std::min<std::size_t>(triangles.size(), 64);
    std::vector<Point<3>> points;
    for (std::size_t i = 0; i < count; ++i) {
      const auto corners = mesh_.corners(static_cast<std::size_t>(triangles[i * triangles.size() / count]));
      Point<3> centroid{};
      for (const Point<3>& corner : corners) {
        points.push_back(corner);
        for (int axis = 0; axis < 3; ++axis) centroid[axis] += corner[axis] / 3.0;
      }
      points.push_back(centroid);
    }
    return points;
  }

  const TriangleMesh& mesh_;
};

/// What became of shells of one kind: how many they are, and the box around the largest.
struct Found {
  int count = 0;
  Bounds box;

  void add(const Shell& shell) {
    if (count++ == 0) box = shell.box;
  }
  std::string text() const {
    return std::to_string(count) + (count == 1 ? " closed surface, " : " closed surfaces, the largest ") +
           to_text<3>(box.low) + ".." + to_text<3>(box.high) + " in the file, ";
  }
};

/// Decides which way each shell is to face.
class Decisions {
 public:
  /// Whether the shell has to be turned. `around`: the shell in which it lies, decided before; null: none.
  bool turns(Shell& shell, const Shell* around) {
    const int outside = around != nullptr ? around->winding : 0;
    const bool inward = shell.volume < 0.0;
    const bool cavity = outside > 0 && inward != (around->volume < 0.0);
    shell.winding = outside + (cavity ? -1 : 1);
    if (cavity) {
      if (shell.winding == 0) cavities_.add(shell);
      return !inward;
    }
    if (outside > 0)
      filled_.add(shell);
    else
      (inward ? inward_ : outward_).add(shell);
    return inward;
  }

  std::vector<std::string> notes() const {
    std::vector<std::string> result;
    if (inward_.count > 0 && outward_.count > 0)
      result.push_back(inward_.text() + "not inside another, turned inside out: taken as solid");
    if (cavities_.count > 0)
      result.push_back(cavities_.text() + "inside another, turned the other way: taken as a cavity, empty");
    if (filled_.count > 0)
      result.push_back(filled_.text() +
                       "inside another, turned like it: taken as solid; if it is a cavity, turn it round");
    return result;
  }

 private:
  Found inward_, outward_, cavities_, filled_;
};

}  // namespace

std::vector<std::string> turn_shells(TriangleMesh& mesh) {
  const std::vector<MeshPiece> pieces = find_mesh_pieces(mesh);
  std::vector<Shell> shells = find_shells(mesh, pieces);
  compare_boxes(shells);
  const Containment containment(mesh);
  for (Shell& shell : shells) {
    const auto found = std::find_if(shell.perhaps.begin(), shell.perhaps.end(), [&](std::int32_t other) {
      return containment.lies_in(shell, shells[other]);
    });
    if (found != shell.perhaps.end()) shell.around = *found;
  }
  Decisions decisions;
  for (Shell& shell : shells)
    if (decisions.turns(shell, shell.around >= 0 ? &shells[shell.around] : nullptr))
      for (const std::int32_t t : shell.piece->triangles)
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  return decisions.notes();
}

}  // namespace fabseq
