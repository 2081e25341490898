// SPDX-License-Identifier: MIT
/// How long the checks of a sequence take (docs/formulation.md 13.1): a cube of so many elements per edge, in
/// so many layers (planar, convex or concave), below a torch as high as the cube.
///
///     mpirun -np 2 build/release/benchmarks/machine_checks [ELEMENTS PER EDGE] [LAYERS]     default: 100 50
#include "fabseq/base/formatted.h"
#include "fabseq/base/machine_cores.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/machine/blocked.h"
#include "fabseq/machine/hanging.h"
#include "fabseq/machine/interior_extrema.h"
#include "fabseq/machine/marked_elements.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace {

using namespace fabseq;

/// Layers and build direction of a part field, in a cube with edges of length 1.
struct Sequence {
  std::vector<double> time, layer, direction;
};

/// `time_of`: pseudo-time and build direction at a place.
template <class Time>
Sequence sequence(const Part<3>& part, int layers, const Time& time_of) {
  Sequence result;
  for (const int element : part.elements()) {
    const Point<3> center = part.grid().element_center(part.grid().owned_elements().index(element));
    const auto [time, direction] = time_of(center);
    result.time.push_back(time);
    result.layer.push_back(std::ceil(time * layers));
    result.direction.insert(result.direction.end(), direction.begin(), direction.end());
  }
  return result;
}

using TimeAndDirection = std::pair<double, Point<3>>;

TimeAndDirection planar(const Point<3>& at) { return {at[2], {0.0, 0.0, 1.0}}; }

/// Spheres around the middle of the plate, from there outwards.
TimeAndDirection convex(const Point<3>& at) {
  const double x = at[0] - 0.5, y = at[1] - 0.5, z = at[2], distance = std::hypot(x, y, z);
  return {distance / std::sqrt(1.5), {x / distance, y / distance, z / distance}};
}

/// Spheres around the middle of the upper face, inwards: what is there stands around the torch.
TimeAndDirection concave(const Point<3>& at) {
  const auto [time, direction] = convex({at[0], at[1], 1.0 - at[2]});
  return {1.0 - time, {-direction[0], -direction[1], direction[2]}};
}

/// Seconds that `what` takes on the slowest rank.
template <class What>
double seconds(const What& what) {
  MPI_Barrier(MPI_COMM_WORLD);
  const double begin = MPI_Wtime();
  what();
  return max(MPI_COMM_WORLD, MPI_Wtime() - begin);
}

void measure(const char* name, const Part<3>& part, const Sequence& sequence, int layers) {
  // A tip, a nozzle and a body, with a step between them.
  ToolSettings tool;
  tool.profile = {{0.02, 0.01}, {0.1, 0.03}, {0.1, 0.08}, {1.0, 0.2}};
  std::vector<double> blocked, hanging;
  const double torch =
      seconds([&] { blocked = blocked_depth<3>(part, Torch(tool), sequence.direction, sequence.layer); });
  const double air = seconds(
      [&] { hanging = hanging_elements<3>(part, sequence.direction, sequence.layer, tool.bead_width); });
  InteriorExtrema extrema;
  const double ends = seconds([&] { extrema = find_interior_extrema<3>(part, sequence.time); });
  MarkedElements marked;
  const double count =
      seconds([&] { marked = count_marked<3>(part, blocked, sequence.layer, layers, MarkedPlace::largest); });
  print(
      formatted("%s: %lld elements, %d layers, %d ranks: blocked %.2f s (%lld elements, %.4f deep), hanging "
                "%.2f s, extrema %.2f s, counts %.3f s",
                name, static_cast<long long>(part.count()), layers, size_of(MPI_COMM_WORLD), torch,
                static_cast<long long>(marked.elements), marked.largest, air, ends, count));
}

void measure_all(int edge, int layers) {
  Shape cube;
  cube.kind = Shape::Kind::box;
  cube.first = {0.0, 0.0, 0.0};
  cube.second = {1.0, 1.0, 1.0};
  const PartDescription description{cube};
  const Domain<3> domain{{1.0, 1.0, 1.0}, {edge, edge, edge}, 1.0};
  const Grid<3> grid = make_balanced_grid<3>(MPI_COMM_WORLD, domain, description);
  const Part<3> part(grid, description, {2, false});
  measure("planar", part, sequence(part, layers, planar), layers);
  measure("convex", part, sequence(part, layers, convex), layers);
  measure("concave", part, sequence(part, layers, concave), layers);
}

}  // namespace

int main(int argc, char** argv) {
  const int edge = argc > 1 ? std::atoi(argv[1]) : 100;
  const int layers = argc > 2 ? std::atoi(argv[2]) : 50;
  return fabseq::run_session({argv[0]}, [&] {
    print("machine: " + machine_text(MPI_COMM_WORLD));
    measure_all(edge, layers);
  });
}
