// SPDX-License-Identifier: MIT
#include "fabseq/process/plastic_process.h"

#include "process/plastic_adjoint.h"
#include "process/plastic_sweeps.h"
#include "process/step_results.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

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
  result_.iterations = forward_->run(tolerance_.flow_change());
  set_steps(systems_, result_);
  result_.increments = forward_->increments();
  groups().run([&] {
    for (std::size_t block = 0; block < result_.increments.size(); ++block)
      count_block(deposition_.get(), input.densities, block, result_);
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
  adjoint_iterations_ = adjoint.run(functionals, derivatives, tolerance_.flow_change(), adjoints_);
  groups().run([&] { add_weight_derivatives(densities, functionals, derivatives); });
}

/// Makes room for the adjoints of so many functionals, zero unless there were as many of the same steps.
void PlasticProcess::keep_adjoints(std::size_t functionals) {
  const auto fits = [this](const std::vector<LaneVector>& waves) { return forward_->fits(waves); };
  if (functionals > StepSystems<3>::most_kept)
    adjoints_.clear();
  else if (adjoints_.size() != functionals || !std::ranges::all_of(adjoints_, fits))
    adjoints_.assign(functionals, forward_->zero_unknowns());
}

/// Adds what comes through the weights of this group's steps.
void PlasticProcess::add_weight_derivatives(const LayerDensities& densities,
                                            std::span<const ProcessAdjoint> functionals,
                                            std::span<const ProcessDerivatives> derivatives) const {
  for (std::size_t block = 0; deposition_ && block < result_.blocks.size(); ++block) {
    const std::vector<Deposition<3>::Missing> missing =
        deposition_->missing(densities, result_.steps_of(block));
    for (std::size_t k = 0; k < functionals.size(); ++k) {
      deposition_->add_derivatives(
          missing, result_.steps_of(block), result_.nodes[block],
          weight_derivatives(functionals[k], result_, block, result_.increments[block]),
          *derivatives[k].densities);
      if (derivatives[k].sink != nullptr) derivatives[k].sink->flush();
    }
  }
}

void PlasticProcess::start_cold() {
  Process<3>::start_cold();
  forget();
}

void PlasticProcess::release_memory() {
  Process<3>::release_memory();
  forget();
}

void PlasticProcess::forget() {
  forward_.reset();
  adjoints_.clear();
}

std::string PlasticProcess::description() const {
  return systems_.solver_description() + "; plastic flow by sweeps";
}

}  // namespace fabseq
