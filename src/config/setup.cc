// SPDX-License-Identifier: MIT
#include "fabseq/config/setup.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/session.h"
#include "fabseq/model/run_cost.h"
#include "fabseq/part/wall_thickness.h"
#include "fabseq/process/release.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/solve/reference/preconditioner.h"
#include "fabseq/solve/solvers.h"

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

template <int Dim>
Setup<Dim>::Setup(MPI_Comm world, const Config& config_) : Model<Dim>(world, config_), config(config_) {
  // Refuses a grid whose lane blocks are too large for the indices before anything is written.
  (void)this->grid.exchange(Dim * std::min(this->lanes, most_layers_of_a_sequence()));
  if (config.solver.path == SolverPath::reference)
    require_solver_options({solver_prefixes.begin(), solver_prefixes.end()});
  require_layers_that_fit();
  require_plate();
  require_release();
  warn_about_method();
}

template <int Dim>
void Setup<Dim>::require_walls() const {
  const auto* mesh = std::get_if<MeshFile>(&config.part.source);
  if (mesh == nullptr || mesh->least_elements == 0.0) return;
  const ThinWall<Dim> wall = thinnest_wall(this->part);
  if (wall.elements >= mesh->least_elements) return;
  refuse("/part/mesh",
         formatted("%.2g elements across the wall at %s", wall.elements, to_text<Dim>(wall.at).c_str()),
         formatted("%g or more (smaller domain.element, or part.mesh.least_elements)", mesh->least_elements));
}

/// Layers by far more than elements could only be empty, and the optimizer has rows for all of them.
template <int Dim>
void Setup<Dim>::require_layers_that_fit() const {
  constexpr int layers_of_an_element = 10;
  const LayerTraits& traits = this->layers->traits();
  const std::int64_t most = layers_of_an_element * this->part.count();
  if (traits.count > most)
    refuse(traits.key, std::to_string(traits.count),
           "at most " + std::to_string(most) + " layers, ten for each of the part's elements");
}

/// Refuses a part that is longer or wider than the machine's plate.
template <int Dim>
void Setup<Dim>::require_plate() const {
  std::vector<double> plate = config.tool.plate, part;
  if (plate.empty()) return;
  for (int axis = 0; axis < Dim; ++axis)
    if (axis != config.plate.axis) part.push_back(this->part.upper()[axis] - this->part.lower()[axis]);
  std::ranges::sort(plate, std::greater());
  std::ranges::sort(part, std::greater());
  constexpr double rounding = 1.0 + 1e-9;
  const bool fits = std::ranges::equal(part, std::span(plate).first(part.size()),
                                       [](double edge, double room) { return edge <= rounding * room; });
  if (fits) return;
  std::string found = formatted("a part of %g", part.front());
  if (part.size() > 1) found += formatted(" x %g", part.back());
  refuse("/tool/plate", found,
         formatted("at most %g x %g, the plate, or [], which is not checked", plate[0], plate[1]));
}

/// Refuses terms after a release that there cannot be.
template <int Dim>
void Setup<Dim>::require_release() const {
  const auto require_for = [&](const std::string& list, const std::vector<Term>& terms) {
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (!terms[i].type->facts(terms[i]).measures_release) continue;
      const std::string reason = release_obstacle(this->grid, this->supports, config.process.void_model);
      if (!reason.empty())
        refuse("/" + list + "/" + std::to_string(i) + "/after_release", "true, but " + reason,
               "false for this part");
    }
  };
  require_for("objective", config.objective);
  require_for("constraints", config.constraints);
}

/// The solvers themselves say nothing: there are many of them.
template <int Dim>
void Setup<Dim>::warn_about_method() const {
  if (config.solver.method != ReferenceMethod::multigrid) return;
  const std::string obstacle = coarsening_obstacle(this->grid);
  if (!obstacle.empty())
    warn("/solver/reference_method: multigrid halves the grid, which has " + obstacle +
         "; gamg is taken in its place");
}

template <int Dim>
Config Setup<Dim>::resolved() const {
  Config result = config;
  if (!result.layers.multi_planar) result.layers.count = this->layers->count();
  result.baseline.layers = this->baseline->count();
  result.sequence = this->sequence_settings;
  return result;
}

template <int Dim>
Json Setup<Dim>::effective() const {
  Json result = config.effective;
  config.sequence.kind->write(this->sequence_settings, result["sequence"]);
  return result;
}

template <int Dim>
void Setup<Dim>::require_memory_of_layers() const {
  const int layer_count = most_layers_of_a_sequence(), group_count = this->groups.count();
  const double bytes =
      layer_count * sizeof(double) *
      (2.0 * group_count * this->size.part_elements + (Dim + 1.0) / Dim * this->size.unknowns);
  const LayerTraits& traits = this->layers->traits();
  const bool planar = layer_count > traits.count;
  require_memory(
      this->world(), bytes,
      (planar ? "/baseline/layers: " : traits.key + (traits.count_is_estimate ? ": about " : ": ")) +
          std::to_string(layer_count) + " layers on " + to_text<Dim>(this->grid.domain().elements) +
          " elements" + (group_count > 1 ? " in " + std::to_string(group_count) + " layer groups" : ""));
}

template <int Dim>
void Setup<Dim>::require_address_space() const {
  if (!any(this->world(), address_space_limit().has_value())) return;
  const double bytes = memory_estimate(this->size, config.solver.path, this->groups.count(), this->lanes);
  const auto available = static_cast<double>(available_memory_bytes(this->world()));
  if (bytes <= available) return;
  const LayerTraits& traits = this->layers->traits();
  throw InputError(traits.key +
                   formatted(": an optimization with %d layers on %s elements takes about %.3g GB of "
                             "memory; allowed: at most the %.3g GB that are left",
                             traits.count, to_text<Dim>(this->grid.domain().elements).c_str(), bytes / 1e9,
                             available / 1e9) +
                   address_space_words());
}

FABSEQ_INSTANTIATE_CLASS(Setup);

}  // namespace fabseq
