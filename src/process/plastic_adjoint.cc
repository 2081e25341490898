// SPDX-License-Identifier: MIT
#include "process/plastic_adjoint.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/process/adjoint_loads.h"
#include "process/anderson.h"

#include <algorithm>

namespace fabseq {

namespace {

constexpr int mode_count = ElementModes::components;
constexpr std::size_t anderson_depth = 8;
constexpr int most_adjoint_sweeps = 400;
/// Tolerance of the solves of a sweep, relative to their load.
constexpr double of_adjoint_corrections = 1e-3;

}  // namespace

PlasticAdjoint::PlasticAdjoint(StepSystems<3>& systems, Release<3>* release, const PlasticSweeps& forward,
                               const ProcessResult& result, const ProcessAdjoint& functional)
    : systems_(systems),
      release_(release),
      forward_(forward),
      functional_(functional),
      displacements_(forward.displacements()),
      history_(forward.history(), forward.fields().modes(), forward.input(), displacements_),
      forces_(systems.blocks().size()) {
  unknowns_.resize(
      forward.first().back() + (release != nullptr ? static_cast<std::size_t>(systems.owned_nodes()) * 3 : 0),
      0.0);
  step_.resize(unknowns_.size());
  set_explicit(result);
}

void PlasticAdjoint::set_explicit(const ProcessResult& result) {
  std::vector<std::vector<double>> values;
  for (std::size_t block = 0; block < forces_.size(); ++block) {
    LaneVector load(systems_.owned_nodes(), 3, result.blocks[block].lanes);
    set_adjoint_load(functional_, result, block, load);
    for (double& value : load.values) value = -value;  // loads are negated derivatives
    explicit_.push_back(std::move(load));
    values.push_back(explicit_.back().values);
  }
  if (!displacements_.accumulated) return;
  const auto owned = static_cast<std::size_t>(systems_.owned_nodes());
  const StepTranspose nodes(systems_.groups(), systems_.deal(), owned, 3);
  std::vector<double> histories = nodes.to_histories(values);
  const std::size_t steps = nodes.steps();
  for (std::size_t node = 0; node < nodes.elements_of_share(); ++node)
    for (std::size_t s = 0; s < steps; ++s)
      for (int a = 0; a < 3; ++a) {
        double& own = histories[(node * steps + s) * 3 + a];
        if (s + 1 < steps)
          own -= histories[(node * steps + s + 1) * 3 + a];
        else if (release_ != nullptr && !functional_.release.empty())
          own -= functional_.release[(nodes.first_element() + node) * 3 + a];
      }
  values = nodes.to_blocks(histories);
  for (std::size_t block = 0; block < values.size(); ++block)
    explicit_[block].values = std::move(values[block]);
}

int PlasticAdjoint::run(double tolerance) {
  const std::vector<double> weights = forward_.product_weights();
  Anderson anderson(systems_.groups().world(), anderson_depth, weights);
  systems_.set_tolerance({of_adjoint_corrections});
  if (release_ != nullptr) release_->set_tolerance(of_adjoint_corrections);
  for (int sweep = 1; sweep <= most_adjoint_sweeps; ++sweep) {
    find_forces(nullptr);
    systems_.solve(forward_.input().densities, SolvePurpose::adjoint, *this, forward_.stiffness_scale());
    if (release_ != nullptr) {
      const std::vector<double> change =
          systems_.groups().from_first(at_release_.size(), [&] { return release_->adjoint(at_release_); });
      std::ranges::copy(change, step_.begin() + static_cast<std::ptrdiff_t>(forward_.first().back()));
    }
    const double change = anderson.norm(step_);
    anderson.advance(unknowns_, step_);
    if (change <= tolerance * anderson.norm(unknowns_)) {
      find_forces(&derivatives_);
      return sweep;
    }
  }
  throw NumericalError(
      formatted("process: the adjoint of the steps still changes by more than %g of it after %d sweeps",
                tolerance, most_adjoint_sweeps));
}

void PlasticAdjoint::find_forces(PlasticDerivatives* derivatives) {
  const LayerGroups& groups = systems_.groups();
  const StepTranspose& elements = forward_.elements();
  const std::size_t all = systems_.model().elements.size(), first = elements.first_element(),
                    count = elements.elements_of_share();
  std::vector<std::vector<double>> modes(forces_.size());
  std::vector<double> of_release, share;
  groups.run([&] {
    for (std::size_t block = 0; block < modes.size(); ++block) {
      LaneVector own(systems_.owned_nodes(), 3, systems_.blocks()[block].block.lanes);
      std::copy_n(unknowns_.begin() + static_cast<std::ptrdiff_t>(forward_.first()[block]), own.values.size(),
                  own.values.begin());
      forward_.fields().set_modes(own, modes[block]);
    }
    if (release_ == nullptr) return;
    LaneVector own(systems_.owned_nodes(), 3, 1);
    own.values.assign(unknowns_.begin() + static_cast<std::ptrdiff_t>(forward_.first().back()),
                      unknowns_.end());
    forward_.fields().set_modes(own, of_release);
    share.assign(of_release.begin() + static_cast<std::ptrdiff_t>(first * mode_count),
                 of_release.begin() + static_cast<std::ptrdiff_t>((first + count) * mode_count));
  });
  const std::vector<double> histories = elements.to_histories(modes);
  std::vector<double> forces, at_release;
  history_.run({histories, share}, forces, at_release, derivatives);
  modes = elements.to_blocks(forces);
  std::vector<double> whole(all * mode_count, 0.0);
  std::ranges::copy(at_release, whole.begin() + static_cast<std::ptrdiff_t>(first * mode_count));
  LaneVector end;
  groups.run([&] {
    for (std::size_t block = 0; block < modes.size(); ++block) {
      forward_.fields().set_forces(modes[block], systems_.blocks()[block].block.lanes, forces_[block]);
      for (std::size_t i = 0; i < forces_[block].values.size(); ++i)
        forces_[block].values[i] += explicit_[block].values[i];
    }
    forward_.fields().set_forces(whole, 1, end);
  });
  groups.sum(end.values);
  at_release_ = std::move(end.values);
  for (std::size_t i = 0; i < functional_.release.size(); ++i) at_release_[i] += functional_.release[i];
}

void PlasticAdjoint::set(std::size_t block, std::size_t, LaneVector& load) {
  for (std::size_t i = 0; i < load.values.size(); ++i) load.values[i] = -forces_[block].values[i];
}

void PlasticAdjoint::take(std::size_t block, std::size_t, LaneVector& solution) {
  std::ranges::copy(solution.values, step_.begin() + static_cast<std::ptrdiff_t>(forward_.first()[block]));
}

}  // namespace fabseq
