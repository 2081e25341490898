// SPDX-License-Identifier: MIT
#include "fabseq/process/plastic_process.h"

#include "fabseq/base/formatted.h"
#include "process/plastic_adjoint.h"
#include "process/plastic_sweeps.h"
#include "process/step_results.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

/// Functionals whose adjoints are kept to begin the next ones: each takes as much memory as the
/// displacements.
constexpr std::size_t most_kept = 2;

/// A state on all owned elements.
LockedIn spread_out(const ElasticModel<3>& model, const PlasticState& state) {
  const auto owned = static_cast<std::size_t>(model.part.grid().owned_elements().count());
  constexpr int strains = voigt_size<3>;
  LockedIn result{std::vector<double>(owned * strains, 0.0), std::vector<double>(owned, 0.0)};
  for (std::size_t e = 0; e < model.elements.size(); ++e) {
    const auto to = static_cast<std::size_t>(model.elements[e]);
    for (int c = 0; c < strains; ++c)
      result.stress[to * strains + c] = model.material.young * state.stress[e * strains + c];
    result.plastic_strain[to] = state.plastic_strain[e];
  }
  return result;
}

}  // namespace

PlasticProcess::~PlasticProcess() = default;

PlasticProcess::PlasticProcess(const ElasticModel<3>& model, std::unique_ptr<ElasticitySolver<3>> solver,
                               const LayerGroups& groups, BlockSolver blocks, int lanes)
    : Process<3>(model, std::move(solver), groups, blocks, lanes) {}

const ProcessResult& PlasticProcess::simulate(const ProcessInput<3>& input) {
  strains_ = &input.strains;
  systems_.deal_out_in_turn(input.steps);
  std::vector<LaneVector> before;
  if (forward_) before = forward_->take_unknowns();
  forward_.reset();
  forward_ = std::make_unique<PlasticSweeps>(
      systems_, release_.get(),
      PlasticInput{input.densities, systems_.steps(), input.temperatures, input.strains});
  forward_->start_from(std::move(before));
  result_.iterations = forward_->run({.change = tolerance_.flow_change()});
  sweeps_ = *std::ranges::max_element(result_.iterations);
  set_steps(systems_, result_);
  result_.increments = forward_->increments();
  groups().run([&] {
    for (std::size_t block = 0; block < result_.increments.size(); ++block) {
      count_block(deposition_.get(), input.densities, block, result_);
    }
  });
  sum_displacements(groups(), result_);
  result_.release = forward_->release();
  built_ = spread_out(model(), forward_->built());
  released_ = spread_out(model(), forward_->released());
  return result_;
}

void PlasticProcess::pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> functionals,
                               std::span<const ProcessDerivatives> derivatives) {
  for (const ProcessDerivatives& to : derivatives) {
    if (to.strains != nullptr) to.strains->resize(strains_->input_count(), 0.0);
    if (to.temperatures != nullptr)
      to.temperatures->assign(result_.steps.size(), std::vector<double>(model().elements.size(), 0.0));
  }
  keep_adjoints(functionals.size());
  PlasticAdjoint adjoint(*forward_, result_);
  adjoint_iterations_ =
      adjoint.run(functionals, derivatives, {.change = tolerance_.flow_change()}, adjoints_);
  groups().run([&] {
    for (std::size_t k = 0; k < functionals.size(); ++k)
      add_weight_derivatives(densities, functionals[k], derivatives[k]);
  });
}

/// Makes room for the adjoints of so many functionals, zero unless there were as many of the same steps.
void PlasticProcess::keep_adjoints(std::size_t functionals) {
  const auto fits = [&](const std::vector<LaneVector>& waves) {
    bool result = waves.size() == forward_->waves().size();
    for (std::size_t wave = 0; result && wave < waves.size(); ++wave)
      result = waves[wave].lanes == forward_->unknowns(wave).lanes;
    return result;
  };
  if (functionals > most_kept) {
    adjoints_.clear();
  } else if (adjoints_.size() != functionals || !std::ranges::all_of(adjoints_, fits)) {
    adjoints_.assign(functionals, {});
    for (std::vector<LaneVector>& waves : adjoints_)
      for (std::size_t wave = 0; wave < forward_->waves().size(); ++wave)
        waves.emplace_back(forward_->unknowns(wave).nodes, 3, forward_->unknowns(wave).lanes);
  }
}

/// Adds what comes through the weights of this group's steps.
void PlasticProcess::add_weight_derivatives(const LayerDensities& densities, const ProcessAdjoint& functional,
                                            const ProcessDerivatives& to) const {
  if (!deposition_) return;
  for (std::size_t block = 0; block < result_.blocks.size(); ++block) {
    std::vector<Deposition<3>::Missing> missing;
    for (const BuildStep& step : result_.steps_of(block))
      missing.push_back(deposition_->missing(densities.stage[step.layer]));
    deposition_->add_derivatives(missing, result_.steps_of(block), result_.nodes[block],
                                 weight_derivatives(functional, result_, block, result_.increments[block]),
                                 *to.densities);
    if (to.sink != nullptr) to.sink->flush();
  }
}

void PlasticProcess::start_cold() {
  Process<3>::start_cold();
  forward_.reset();
  adjoints_.clear();
}

void PlasticProcess::release_memory() {
  Process<3>::release_memory();
  forward_.reset();
  adjoints_.clear();
}

std::string PlasticProcess::description() const {
  return systems_.solver_description() + "; plastic flow by sweeps";
}

}  // namespace fabseq
