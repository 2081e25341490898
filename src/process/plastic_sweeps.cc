// SPDX-License-Identifier: MIT
#include "process/plastic_sweeps.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "process/anderson.h"

#include <algorithm>

namespace fabseq {

namespace {

constexpr int components = ElementModes::components;
constexpr std::size_t depth = 6;  ///< of Anderson's method
constexpr int most_sweeps = 300;
/// Tolerance of the solves of a sweep, relative to their load.
constexpr double of_corrections = 1e-3;

}  // namespace

PlasticSweeps::PlasticSweeps(StepSystems<3>& systems, Release<3>* release, const LayerDensities& densities,
                             const StrainSource<3>& strains, const StepTemperatures* temperatures)
    : systems_(systems),
      release_(release),
      input_{densities, systems.steps(), temperatures, strains},
      fields_(systems.model()),
      history_(systems.model()),
      elements_(systems.groups(), systems.deal(), systems.model().elements.size(), components) {
  first_.push_back(0);
  for (const BlockRegion& block : systems.blocks())
    first_.push_back(first_.back() + static_cast<std::size_t>(systems.owned_nodes()) * 3 * block.block.lanes);
  const std::size_t of_release = release != nullptr ? static_cast<std::size_t>(systems.owned_nodes()) * 3 : 0;
  unknowns_.resize(first_.back() + of_release, 0.0);
  step_.resize(unknowns_.size());
  forces_.resize(systems.blocks().size());
}

LaneVector PlasticSweeps::of_block(std::size_t block) const {
  LaneVector result(systems_.owned_nodes(), 3, systems_.blocks()[block].block.lanes);
  std::copy_n(unknowns_.begin() + static_cast<std::ptrdiff_t>(first_[block]), result.values.size(),
              result.values.begin());
  return result;
}

int PlasticSweeps::run(double tolerance) {
  const std::vector<double> weights = product_weights();
  Anderson anderson(systems_.groups().world(), depth, weights);
  systems_.set_tolerance({of_corrections});
  if (release_ != nullptr) release_->set_tolerance(of_corrections);
  for (int sweep = 1; sweep <= most_sweeps; ++sweep) {
    find_histories();
    find_step(sweep == 1);
    const double change = anderson.norm(step_);
    anderson.advance(unknowns_, step_);
    if (change <= tolerance * anderson.norm(unknowns_)) {
      find_histories();
      return sweep;
    }
  }
  throw NumericalError(formatted(
      "process: the displacements of the steps still change by more than %g of them after %d sweeps",
      tolerance, most_sweeps));
}

void PlasticSweeps::find_histories() {
  const LayerGroups& groups = systems_.groups();
  const std::size_t all = systems_.model().elements.size(), first = elements_.first_element(),
                    count = elements_.elements_of_share();
  std::vector<std::vector<double>> modes(forces_.size());
  std::vector<double> of_release;
  groups.run([&] {
    for (std::size_t block = 0; block < modes.size(); ++block)
      fields_.set_modes(of_block(block), modes[block]);
    if (release_ == nullptr) return;
    LaneVector displacement(systems_.owned_nodes(), 3, 1);
    displacement.values = release();
    fields_.set_modes(displacement, of_release);
  });
  histories_ = elements_.to_histories(modes);
  of_release_.clear();
  if (release_ != nullptr)
    of_release_.assign(of_release.begin() + static_cast<std::ptrdiff_t>(first * components),
                       of_release.begin() + static_cast<std::ptrdiff_t>((first + count) * components));
  history_.run(input_, displacements(), output_);
  modes = elements_.to_blocks(output_.forces);
  std::vector<double> at_end(all * components, 0.0);
  std::ranges::copy(output_.at_end, at_end.begin() + static_cast<std::ptrdiff_t>(first * components));
  LaneVector end;
  groups.run([&] {
    for (std::size_t block = 0; block < modes.size(); ++block)
      fields_.set_forces(modes[block], systems_.blocks()[block].block.lanes, forces_[block]);
    fields_.set_forces(at_end, 1, end);
  });
  groups.sum(end.values);
  force_at_end_ = std::move(end.values);
}

void PlasticSweeps::find_step(bool first) {
  systems_.solve(input_.densities, first ? SolvePurpose::forward : SolvePurpose::correction, *this,
                 stiffness_scale());
  if (release_ == nullptr) return;
  const std::vector<double> change = systems_.groups().from_first(
      force_at_end_.size(), [&] { return release_->displacement(force_at_end_); });
  std::ranges::copy(change, step_.begin() + static_cast<std::ptrdiff_t>(first_.back()));
}

void PlasticSweeps::scale(const BlockRegion& block, std::span<double> stiffness) const {
  const int lanes = block.block.lanes;
  for (int lane = 0; lane < lanes; ++lane) {
    const std::vector<double>& temperature = input_.temperatures->elements[block.block.first + lane];
    for (std::size_t e = 0; e < temperature.size(); ++e)
      stiffness[e * lanes + lane] *= history_.curves().young(temperature[e]);
  }
}

/// The diagonal of the steps' stiffness, about.
std::vector<double> PlasticSweeps::product_weights() const {
  const ElasticModel<3>& model = systems_.model();
  std::vector<double> weights(unknowns_.size());
  systems_.groups().run([&] {
    const auto set = [&](std::span<const double> stiffness, int lanes, std::size_t first, double factor) {
      const LaneVector nodal = systems_.elements().at_nodes(stiffness, lanes);
      for (std::size_t i = 0; i < nodal.unknowns() * 3; ++i)
        for (int lane = 0; lane < lanes; ++lane)
          weights[first + i * lanes + lane] = factor * nodal(i / 3, lane);
    };
    for (std::size_t block = 0; block < systems_.blocks().size(); ++block) {
      const BlockRegion& region = systems_.blocks()[block];
      std::vector<double> stiffness = systems_.elements().stiffness(input_.densities, region);
      if (accumulated()) scale(region, stiffness);
      set(stiffness, region.block.lanes, first_[block], 1.0);
    }
    // All copies have the release.
    if (release_ != nullptr)
      set(model.finished_stiffness(), 1, first_.back(), 1.0 / systems_.groups().count());
  });
  return weights;
}

ScaleStiffness PlasticSweeps::stiffness_scale() const {
  if (!accumulated()) return {};
  return [this](const BlockRegion& block, std::span<double> stiffness) { scale(block, stiffness); };
}

PlasticHistory::Displacements PlasticSweeps::displacements() const {
  return {elements_.first_element(), histories_, accumulated(), of_release_};
}

std::size_t PlasticSweeps::begin(std::size_t) { return 1; }

void PlasticSweeps::set(std::size_t block, std::size_t, LaneVector& load) {
  for (std::size_t i = 0; i < load.values.size(); ++i) load.values[i] = -forces_[block].values[i];
}

void PlasticSweeps::take(std::size_t block, std::size_t, LaneVector& solution) {
  std::ranges::copy(solution.values, step_.begin() + static_cast<std::ptrdiff_t>(first_[block]));
}

std::vector<LaneVector> PlasticSweeps::increments() const {
  std::vector<LaneVector> result;
  for (std::size_t block = 0; block < forces_.size(); ++block) result.push_back(of_block(block));
  if (!accumulated()) return result;
  const StepTranspose nodes(systems_.groups(), systems_.deal(),
                            static_cast<std::size_t>(systems_.owned_nodes()), 3);
  std::vector<std::vector<double>> values;
  for (const LaneVector& block : result) values.push_back(block.values);
  std::vector<double> histories = nodes.to_histories(values);
  const std::size_t steps = nodes.steps();
  for (std::size_t node = 0; node < nodes.elements_of_share(); ++node)
    for (std::size_t s = steps; s-- > 1;)
      for (int a = 0; a < 3; ++a)
        histories[(node * steps + s) * 3 + a] -= histories[(node * steps + s - 1) * 3 + a];
  values = nodes.to_blocks(histories);
  for (std::size_t block = 0; block < result.size(); ++block) result[block].values = std::move(values[block]);
  return result;
}

std::vector<double> PlasticSweeps::release() const {
  return {unknowns_.begin() + static_cast<std::ptrdiff_t>(first_.back()), unknowns_.end()};
}

}  // namespace fabseq
