// SPDX-License-Identifier: MIT
#include "fabseq/tasks/coarse_grid.h"

#include "fabseq/base/error.h"
#include "fabseq/keys/config_key.h"
#include "tasks/carried_design.h"
#include "tasks/write_design.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

constexpr const char* key = "/optimizer/coarse_iterations";
/// Fewer elements along an axis are not halved.
constexpr int fewest_elements = 4;

template <int Dim>
[[noreturn]] void refuse_coarse(const Setup<Dim>& fine, const std::string& reason) {
  refuse(key, std::to_string(fine.config.optimizer.coarse_iterations) + ", but " + reason, "0");
}

template <int Dim>
void require_halves(const Setup<Dim>& fine) {
  const Index<Dim>& elements = fine.grid.domain().elements;
  if (*std::min_element(elements.begin(), elements.end()) < fewest_elements)
    refuse_coarse(fine, "the grid of " + to_text<Dim>(elements) + " elements has fewer than " +
                            std::to_string(fewest_elements) + " along an axis");
  const BuildPlate& plate = fine.part.plate();
  if (plate.upper && elements[plate.axis] % 2 != 0)
    refuse_coarse(fine, "the build plate " + plate.name() +
                            " is no face of the coarse grid, which reaches beyond that end of " +
                            std::to_string(elements[plate.axis]) + " elements");
  if (fine.design_support.on_nodes()) refuse_coarse(fine, "the design is on nodes");
}

/// Keeps what goes on beyond the fine box, such as a half space, within it.
template <int Dim>
void clip(const Domain<Dim>& domain, Shape& shape) {
  Shape box;
  box.kind = Shape::Kind::box;
  for (int axis = 0; axis < Dim; ++axis) {
    box.first.push_back(domain.origin[axis]);
    box.second.push_back(domain.origin[axis] + domain.size[axis]);
  }
  Shape clipped;
  clipped.kind = Shape::Kind::intersection;
  clipped.operands = {std::move(box), std::move(shape)};
  shape = std::move(clipped);
}

/// Box and part of the coarse grid.
template <int Dim>
void coarsen_domain(const Setup<Dim>& fine, Config& config) {
  const Domain<Dim>& domain = fine.grid.domain();
  bool larger = false;
  for (int axis = 0; axis < Dim; ++axis) {
    config.elements[axis] = (domain.elements[axis] + 1) / 2;
    if (domain.elements[axis] % 2 == 0) continue;
    config.size[axis] = config.elements[axis] * 2 * fine.grid.spacing()[axis];
    larger = true;
  }
  if (auto* shape = std::get_if<Shape>(&config.part.source); shape != nullptr && larger) clip(domain, *shape);
  if (auto* mesh = std::get_if<MeshFile>(&config.part.source))
    mesh->least_elements = 0.0;  // as on the fine grid
  config.part.sampling *= 2;
}

/// Shares the coarse iterations out: to this grid, and, if there are more, to the coarser ones.
void share_out_iterations(OptimizerSettings& optimizer) {
  const int share = (optimizer.coarse_iterations + optimizer.coarse_grids - 1) / optimizer.coarse_grids;
  optimizer.later_iterations += optimizer.max_iterations;
  optimizer.max_iterations = share;
  optimizer.coarse_iterations -= share;
  optimizer.coarse_grids = std::max(1, optimizer.coarse_grids - 1);
}

template <int Dim>
bool has_nodes(const Part<Dim>& part, const std::string& name, const NodeSetDescription& description) {
  try {
    (void)make_node_set(part, name, description);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// Node sets without nodes, or with fewer than are to be sampled, take those within an edge of a fine
/// element; if these are too few for samples, all.
template <int Dim>
void widen_node_sets(const Setup<Dim>& fine, Config& coarse) {
  const Grid<Dim> grid = make_balanced_grid<Dim>(fine.groups.domain(), coarse.domain<Dim>(), coarse.part);
  const Part<Dim> part(grid, coarse.part, coarse.plate);
  const double within = 1.001 * fine.grid.largest_spacing();
  for (auto& [name, description] : coarse.node_sets) {
    if (has_nodes(part, name, description)) continue;
    description.within += within;
    if (!has_nodes(part, name, description)) description.samples = 0;
  }
}

/// The config of the coarse run, with what "auto" stands for on the fine grid.
template <int Dim>
Config coarsened(const Setup<Dim>& fine) {
  Config config = fine.resolved();
  coarsen_domain(fine, config);
  share_out_iterations(config.optimizer);
  config.output.sensitivity = false;
  config.baseline.best_direction = config.baseline.even = false;  // for the end of the fine run
  widen_node_sets(fine, config);
  complete_derived(config);
  return config;
}

}  // namespace

template <int Dim>
CoarseGrid<Dim>::CoarseGrid(const Setup<Dim>& fine) {
  require_halves(fine);
  try {
    config_ = std::make_unique<const Config>(coarsened(fine));
    setup_ = std::make_unique<const Setup<Dim>>(fine.world(), *config_);
    // The next one, if there is any, is made again when its turn comes.
    if (config_->optimizer.coarse_iterations > 0) (void)CoarseGrid<Dim>(*setup_);
  } catch (const InputError& error) {
    refuse_coarse(fine, std::string("half the resolution is refused: ") + error.what());
  }
}

template <int Dim>
FirstDesign CoarseGrid<Dim>::refine(const Setup<Dim>& fine, const Design& design,
                                    const std::string& directory) const {
  FirstDesign result{carried_design(*setup_, design, fine, /*factor=*/2), directory + "/refined.h5"};
  write_design(fine, result.design, result.file);
  return result;
}

template <int Dim>
std::optional<CoarseGrid<Dim>> make_coarse_grid(const Setup<Dim>& fine, const CommandLine& command_line) {
  if (fine.config.optimizer.coarse_iterations == 0) return std::nullopt;
  if (command_line.design_file) refuse_coarse(fine, "-design names a design of the fine grid");
  return CoarseGrid<Dim>(fine);
}

FABSEQ_INSTANTIATE_CLASS(CoarseGrid);
FABSEQ_INSTANTIATE_FUNCTION(make_coarse_grid);

}  // namespace fabseq
