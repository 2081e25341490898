// SPDX-License-Identifier: MIT
/// How long a mesh takes to become elements: a torus of so many triangles, inside out, in a box of so many
/// elements, of which each rank has a slab as thick as the others'.
///
///     mpirun -np 2 build/release/benchmarks/voxelize [TRIANGLES] [ELEMENTS PER EDGE]     default: 1000000
///     400
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/mesh/mesh_interior.h"

#include <cmath>
#include <cstdlib>
#include <numeric>

namespace {

using namespace fabseq;

constexpr double major = 0.3, minor = 0.15;

/// Rings of `rings` points around the tube of a torus in the unit cube.
TriangleMesh torus(std::int64_t triangles) {
  const int rings = std::max(3, static_cast<int>(std::sqrt(0.5 * static_cast<double>(triangles) / 2.0)));
  const int around = 2 * rings;
  TriangleMesh mesh;
  const auto number = [&](int i, int j) { return i % around * rings + j % rings; };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < rings; ++j) {
      const double u = 2 * M_PI * i / around, v = 2 * M_PI * j / rings,
                   distance = major + minor * std::cos(v);
      mesh.points.push_back(
          {0.5 + distance * std::cos(u), 0.5 + distance * std::sin(u), 0.5 + minor * std::sin(v)});
      mesh.triangles.push_back({number(i + 1, j), number(i, j), number(i + 1, j + 1)});
      mesh.triangles.push_back({number(i + 1, j + 1), number(i, j), number(i, j + 1)});
    }
  return mesh;
}

void measure(std::int64_t triangles, int edge) {
  const MPI_Comm world = MPI_COMM_WORLD;
  const TriangleMesh mesh = torus(triangles);
  const double begin = MPI_Wtime();
  const MeshInterior interior(mesh);
  const double built = max(world, MPI_Wtime() - begin);
  IndexBox<3> box{{}, {edge, edge, edge}};
  box.start[2] = static_cast<int>(std::int64_t{edge} * rank_of(world) / size_of(world));
  box.size[2] = static_cast<int>(std::int64_t{edge} * (rank_of(world) + 1) / size_of(world)) - box.start[2];
  const FillFractions filled = interior.fill_fractions({{}, {1.0 / edge, 1.0 / edge, 1.0 / edge}}, box);
  const double seconds = max(world, MPI_Wtime() - begin) - built;
  const double volume = sum(world, std::accumulate(filled.of_element.begin(), filled.of_element.end(), 0.0)) /
                        std::pow(edge, 3);
  const double exact = 2 * M_PI * M_PI * major * minor * minor;
  print(formatted(
      "%zu triangles, %d^3 elements, %d ranks: set-up %.2f s, elements %.2f s, volume %.6f (torus %.6f)",
      mesh.triangles.size(), edge, size_of(world), built, seconds, volume, exact));
}

}  // namespace

int main(int argc, char** argv) {
  const std::int64_t triangles = argc > 1 ? std::atoll(argv[1]) : 1000000;
  const int edge = argc > 2 ? std::atoi(argv[2]) : 400;
  return fabseq::run_session({argv[0]}, [&] { measure(triangles, edge); });
}
