// SPDX-License-Identifier: MIT
#include "fabseq/base/formatted.h"
#include "fabseq/base/machine_cores.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/machine/holes.h"
#include "fabseq/model/stage_cost.h"
#include "fabseq/part/wall_thickness.h"
#include "fabseq/report/verdict.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/sequence_kind.h"
#include "fabseq/tasks/tasks.h"
#include "tasks/advice.h"

#include <cmath>
#include <string>

namespace fabseq {

namespace {

/// The machine as it is now: estimates hold for cores that do nothing else.
void print_machine(MPI_Comm world) {
  const NodeCores cores = fewest_cores(world);
  print("machine: " + machine_text(cores, busy_share(world)));
  if (cores.ranks > cores.cores)
    warn(formatted("machine: %d ranks share %d core%s: more ranks than cores gain nothing", cores.ranks,
                   cores.cores, cores.cores == 1 ? "" : "s"));
  else if (cores.ranks > 1 && cores.ranks >= cores.usable() + 1.0)
    warn(formatted("machine: %d ranks share the time of %.3g cores: more ranks than that gain nothing",
                   cores.ranks, cores.usable()));
}

/// What a machine file has said, or the config's own tool.
template <int Dim>
void print_tool(const Setup<Dim>& setup) {
  const ToolSettings& tool = setup.config.tool;
  if (tool.name.empty()) return;
  const std::string& unit = setup.settings.unit;
  std::string line = "cell: " + tool.name + "; ";
  line += tool.axis.empty() ? "the torch stands on the layers" : "the torch stands upright on layers";
  if (tool.max_tilt < 180.0) line += formatted(", which lean up to %g degrees", tool.max_tilt);
  line += "; beads " + length_words(tool.bead_width, unit) + " wide";
  if (tool.bead_height) line += " and " + length_words(*tool.bead_height, unit) + " high";
  if (const auto& target = setup.config.layers.target)
    line += "; layers of " + length_words(target->value, unit) + ", in places " +
            length_words(tool.thickness[0] * target->value, unit) + " to " +
            length_words(tool.thickness[1] * target->value, unit);
  if (const auto& rate = setup.config.process.deposition_rate) line += formatted("; %g kg/h", *rate);
  print(line);
}

template <int Dim>
void print_cost(const Setup<Dim>& setup) {
  const int ranks = size_of(setup.world());
  const SolverPath path = setup.config.solver.path;
  const RunSize& size = setup.size;
  print(formatted("one layer: %.0f unknowns; %d layers, %d solves each an iteration", size.unknowns,
                  size.layers, 1 + size.cases + size.functionals));
  if (!setup.group_choice.explanation.empty()) print(setup.group_choice.explanation);
  const OptimizerSettings& optimizer = setup.config.optimizer;
  print(formatted("estimate (%s, %d ranks): memory %.2f GB, %.1f s an iteration, %d iterations",
                  path == SolverPath::lanes ? "lanes" : "reference path", ranks,
                  memory_estimate(size, path, setup.groups.count(), setup.lanes) / 1e9,
                  iteration_seconds_estimate(size, path), optimizer.max_iterations));
  if (optimizer.coarse_iterations > 0)
    print(formatted("before that, on grids of half the resolution: %d iterations",
                    optimizer.coarse_iterations));
  if (!optimizer.starts.empty())
    print(formatted("before that, from each of %zu starts: %d iterations", optimizer.starts.size(),
                    optimizer.start_iterations));
}

/// How far heat gets while a layer of the mean mass is built, how finely its steps resolve that, and what
/// they cost. Fourier numbers refer to the smallest edge of an element.
template <int Dim>
void print_temperature(const Setup<Dim>& setup) {
  if (!setup.config.thermal) return;
  const ThermalProperties properties(*setup.config.thermal, setup.config.material, setup.config.process);
  const double welding =
      properties.mass_density * setup.part.volume() / (setup.layers->count() * properties.rate);
  const double with_torch = welding + (properties.passes - 1) * properties.pause;
  const double edge = setup.grid.smallest_spacing();
  const auto fourier = [&](double seconds) { return properties.diffusivity() * seconds / (edge * edge); };
  print(
      formatted("temperature: a layer takes %.4g s of welding and %d times %.4g s of pause, in which heat "
                "gets %.4g far (diffusion length)",
                welding, properties.passes, properties.pause,
                2.0 * std::sqrt(properties.diffusivity() * (with_torch + properties.pause))));
  std::string steps = formatted("its steps: %d while welding, Fourier number %.3g each",
                                properties.welding_steps, fourier(with_torch / properties.welding_steps));
  if (properties.pause > 0.0)
    steps += formatted("; %d in the last pause, %.3g each", properties.pause_steps,
                       fourier(properties.pause / properties.pause_steps));
  print(steps);
  const SolverPath path = setup.config.solver.path;
  for (const NamedStageCost& stage : stage_costs()) {
    if (stage.stage != "temperature") continue;
    const StageCost cost = stage.of(setup.size, path, setup.groups.count(), setup.lanes);
    print(formatted(
        "it costs %.0f %s for %.0f nodes and as many adjoint solves: %.3g GB, %.2g s an iteration",
        setup.size.temperature_steps, properties.constant() ? "solves" : "steps of about three solves each",
        setup.size.solid_nodes, (cost.held + cost.solving) / 1e9, cost.seconds));
  }
}

/// What the material flows beyond, where it does.
void print_flow(const MaterialSettings& material, const ProcessSettings& process) {
  if (process.model != ProcessModel::linear)
    print(formatted("plastic flow: beyond a yield stress of %g, with a hardening of %g",
                    material.yield_stress.value(), material.hardening));
}

/// The mesh that the part comes from, and how much of it the elements have.
template <int Dim>
void print_mesh(const Setup<Dim>& setup) {
  const auto& mesh = setup.config.part.mesh;
  if (!mesh) return;
  print(formatted("mesh: %zu triangles, volume %.6g; its elements have %.4f times as much",
                  mesh->triangle_count(), mesh->volume(), setup.part.share_of_mesh()));
  print("placed in " + to_text<3>(mesh->lower()) + " to " + to_text<3>(mesh->upper()));
}

/// The characteristic length of a config that leaves it open.
template <int Dim>
double default_length(const Setup<Dim>& setup) {
  const SequenceKind& kind = *setup.config.sequence.kind;
  SequenceSettings defaults = kind.read(Json::object({{"type", kind.name}}), {"/sequence", Dim});
  kind.fix_lengths(defaults, setup.part, setup.config.layers.height_of(setup.layers->count()));
  return defaults.facts.characteristic_length.value_or(setup.part.longest_edge());
}

template <int Dim>
void print_walls(const Part<Dim>& part) {
  const ThinWall<Dim> wall = thinnest_wall(part);
  if (wall.elements >= thick_wall)
    print(formatted("thinnest wall: %g elements or more", thick_wall));
  else
    print(formatted("thinnest wall: %.2g elements at %s", wall.elements, to_text<Dim>(wall.at).c_str()));
}

/// What a simulated layer stands for.
template <int Dim>
void print_beads(const Setup<Dim>& setup) {
  const LayerSettings& layers = setup.config.layers;
  if (layers.passes == 1) return;
  std::string thickness;
  if (layers.target) thickness = ", " + length_words(layers.target->bead, setup.settings.unit) + " each";
  print(formatted("beads: a layer stands for %d one above the other", layers.passes) + thickness);
}

/// Where no sequence within the tilt can carry the part, whatever it is.
template <int Dim>
void print_uncarried(const Setup<Dim>& setup) {
  constexpr std::size_t most = 10;
  const ToolSettings& tool = setup.config.tool;
  const std::string& unit = setup.settings.unit;
  if (setup.part.share_of_stock() > 0.0)
    print("machining stock: " + percent_words(setup.part.share_of_stock()) + " of the part");
  const auto places = find_uncarried(setup.part, tool);
  for (std::size_t i = 0; i < places.size() && i < most; ++i) {
    const UncarriedPlace<Dim>& place = places[i];
    const std::string why = formatted(", which no layers within %.3g degrees carry: ", tool.max_tilt);
    if (place.is_roof)
      print("hole: " + to_text<Dim>(place.hole_lower) + " to " + to_text<Dim>(place.hole_upper) +
            ", its roof spans " + length_words(place.span, unit) + why + "a bead bridges " +
            length_words(bridged_span(setup.part, tool), unit) +
            "; close it (stock; fabseq-tools new --fill-holes) and drill");
    else
      print("in the air: " + to_text<Dim>(place.lower) + " to " + to_text<Dim>(place.upper) + why +
            "turn the part, or let the table tilt further");
  }
  if (places.size() > most) print(formatted("%zu other such places", places.size() - most));
}

}  // namespace

template <int Dim>
void run_check(const Setup<Dim>& setup) {
  const Part<Dim>& part = setup.part;
  const std::vector<double> distance = geodesic_distance(part);
  print("config " + setup.config.name);
  print(formatted("part: %lld elements of %lld (fill %.4f), volume %.6g",
                  static_cast<long long>(part.count()),
                  static_cast<long long>(setup.grid.all_elements().count()),
                  static_cast<double>(part.count()) / static_cast<double>(setup.grid.all_elements().count()),
                  part.volume()));
  print_mesh(setup);
  print("bounding box " + to_text<Dim>(part.lower()) + " to " + to_text<Dim>(part.upper()));
  print(formatted("pieces: %zu", part.pieces().size()));
  for (std::size_t i = 0; i < part.pieces().size() && i < 10; ++i) {
    const Piece<Dim>& piece = part.pieces()[i];
    print("  " + std::to_string(piece.elements) + " elements in " + to_text<Dim>(piece.min) + " to " +
          to_text<Dim>(piece.max) + (piece.touches_plate ? ", on the plate" : ", not on the plate"));
  }
  const bool on_substrate = part.substrate().count() > 0;
  const std::string place_of_contact = on_substrate ? "contact with plate or substrate: " : "plate contact: ";
  if (on_substrate) print("substrate: " + std::to_string(part.substrate().count()) + " elements");
  print(place_of_contact + std::to_string(part.plate_contact()) + " elements");
  if (on_substrate || setup.config.part.clamps) {
    const auto clamped = sum(setup.grid.comm(), static_cast<std::int64_t>(setup.supports.holding.size()));
    print("clamped: " + std::to_string(clamped) + " nodes");
  }
  const double height = geodesic_height(part, distance);
  print_tool(setup);
  print_walls(part);
  print_uncarried(setup);
  print(formatted("height along the plate's normal %.6g, geodesic %.6g", planar_height(part, {}), height));
  const LayerTraits& layers = setup.layers->traits();
  print(formatted("layers: %s%d %s, %d planar in the baseline", layers.count_is_estimate ? "about " : "",
                  layers.count, layers.kind.c_str(), setup.baseline->count()));
  print_beads(setup);
  print(formatted("elements per layer: %.3g; characteristic length %.6g, by default %.6g",
                  elements_per_layer(setup, height), setup.characteristic_length, default_length(setup)));
  const std::int64_t variables =
      sum(part.grid().comm(), static_cast<std::int64_t>(setup.design_support.size()));
  print(formatted("design variables: %lld on %s, %zu %s", static_cast<long long>(variables),
                  setup.design_support.on_nodes() ? "nodes" : "elements", layers.variables.count(),
                  layers.variables.label.c_str()));
  for (const auto& [name, nodes] : setup.node_sets)
    print("node set " + name + ": " + std::to_string(nodes.count) + " nodes");
  print_temperature(setup);
  print_flow(setup.config.material, setup.config.process);
  print_machine(setup.world());
  print_cost(setup);
  for (const std::string& line : advice(setup, distance, height)) warn(line);
}

FABSEQ_INSTANTIATE_FUNCTION(run_check);

}  // namespace fabseq
