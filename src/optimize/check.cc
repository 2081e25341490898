#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/optimize/tasks.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "fabseq/sequence/given_sequence.h"
#include "fabseq/solve/reference_elasticity.h"

#include <cstdio>

namespace fabseq {

namespace {

/// What a path needs, measured (docs/performance.md).
struct PathCost {
  const char* name;
  double bytes_per_unknown;    ///< of a system with its preconditioner; lanes: of all that are solved at once
  double bytes_per_rank;       ///< that a rank holds anyway
  double seconds_per_unknown;  ///< of a solve on one core
};
constexpr PathCost lanes_cost{"lanes", 2500.0, 8e7, 4.5e-7};
constexpr PathCost reference_cost{"reference path", 3000.0, 8e7, 1e-5};
/// Of the reference path's factors, which are kept a layer.
constexpr double factor_bytes_per_unknown = 5000.0;

template <class... Arguments>
void print_line(const char* format, Arguments... arguments) {
  char line[200];
  std::snprintf(line, sizeof line, format, arguments...);
  print(line);
}

template <int Dim>
std::string place(const Point<Dim>& point) {
  std::string text = "[";
  for (int axis = 0; axis < Dim; ++axis) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.6g", axis > 0 ? "," : "", point[axis]);
    text += number;
  }
  return text + "]";
}

template <int Dim>
void print_cost(const Setup<Dim>& setup) {
  std::int64_t nodes = 0;
  for (const char touched : setup.part.touched_nodes()) nodes += touched;
  nodes = sum(setup.grid.comm(), nodes);
  if (setup.config.process.void_model == VoidModel::quiet) nodes = setup.grid.all_nodes().count();
  const double unknowns = static_cast<double>(nodes) * Dim;
  const double all_nodes = static_cast<double>(setup.grid.all_nodes().count());
  const int layers = setup.layer_count;
  const bool in_lanes = setup.config.solver.path == SolverPath::lanes;
  const PathCost& cost = in_lanes ? lanes_cost : reference_cost;
  const bool kept = !in_lanes && unknowns <= static_cast<double>(ReferenceElasticity<Dim>::keep_limit);
  const double systems = unknowns * (kept ? layers * factor_bytes_per_unknown : cost.bytes_per_unknown);
  const double memory = systems + size_of(setup.grid.comm()) * cost.bytes_per_rank +
                        all_nodes * (900.0 + 8.0 * Dim * layers) +
                        static_cast<double>(setup.part.count()) * layers * 16.0 * 4.0;
  const int ranks = size_of(setup.grid.comm());
  print_line("one layer: %.0f unknowns; %d layers, two solves each an iteration", unknowns, layers);
  print_line("estimate (%s, %d ranks): memory %.2f GB, %.1f s an iteration, %d iterations", cost.name, ranks,
             memory / 1e9, 2.0 * layers * unknowns * cost.seconds_per_unknown / ranks,
             setup.config.optimizer.max_iterations);
}

}  // namespace

template <int Dim>
void run_check(const Setup<Dim>& setup) {
  const Part<Dim>& part = setup.part;
  const std::vector<double> distance = geodesic_distance(part);
  print("config " + setup.config.name);
  print_line("part: %lld elements of %lld (fill %.4f), volume %.6g", static_cast<long long>(part.count()),
             static_cast<long long>(setup.grid.all_elements().count()),
             static_cast<double>(part.count()) / static_cast<double>(setup.grid.all_elements().count()),
             part.volume());
  print("bounding box " + place<Dim>(part.lower()) + " to " + place<Dim>(part.upper()));
  print_line("pieces: %zu", part.pieces().size());
  for (std::size_t i = 0; i < part.pieces().size() && i < 10; ++i) {
    const Piece<Dim>& piece = part.pieces()[i];
    print("  " + std::to_string(piece.elements) + " elements in " + place<Dim>(piece.min) + " to " +
          place<Dim>(piece.max) + (piece.touches_plate ? ", on the plate" : ", not on the plate"));
  }
  print_line("plate contact: %lld elements", static_cast<long long>(part.plate_contact()));
  print_line("height along the plate's normal %.6g, geodesic %.6g", planar_height(part, {}),
             geodesic_height(part, distance));
  print_line("layers: %d curved, %d planar in the baseline", setup.layer_count, setup.baseline_layers);
  for (const auto& [name, nodes] : setup.node_sets)
    print("node set " + name + ": " + std::to_string(nodes.count) + " nodes");
  print_cost(setup);
}

template void run_check<2>(const Setup<2>&);
template void run_check<3>(const Setup<3>&);

}  // namespace fabseq
