// SPDX-License-Identifier: MIT
#include "fabseq/process/plastic_process.h"

#include "fabseq/base/formatted.h"
#include "process/plastic_sweeps.h"
#include "process/step_results.h"

#include <stdexcept>

namespace fabseq {

namespace {

/// Sweeps end when they change the displacements by less than this share of the tolerance.
constexpr double share_of_tolerance = 0.1;

}  // namespace

PlasticProcess::PlasticProcess(const ElasticModel<3>& model, std::unique_ptr<ElasticitySolver<3>> solver,
                               const LayerGroups& groups, BlockSolver blocks, int lanes)
    : Process<3>(model, std::move(solver), groups, blocks, lanes) {}

const ProcessResult& PlasticProcess::simulate(const ProcessInput<3>& input) {
  strains_ = &input.strains;
  systems_.deal_out(input.densities, input.steps);
  PlasticSweeps sweeps(systems_, release_.get(), input.densities, input.strains, input.temperatures);
  sweeps_ = sweeps.run(share_of_tolerance * tolerance_);
  set_steps(systems_, result_);
  const std::vector<LaneVector> increments = sweeps.increments();
  groups().run([&] {
    for (std::size_t block = 0; block < increments.size(); ++block) {
      pick(increments[block], result_.nodes[block], result_.increments[block]);
      count_block(deposition_.get(), input.densities, block, result_);
    }
  });
  sum_displacements(groups(), result_);
  result_.iterations.assign(systems_.steps().size(), sweeps_);
  result_.release = sweeps.release();
  built_ = gathered(sweeps.built().stress, sweeps.built().plastic_strain);
  released_ = gathered(sweeps.released().stress, sweeps.released().plastic_strain);
  return result_;
}

void PlasticProcess::pull_back(const LayerDensities&, std::span<const ProcessAdjoint>,
                               std::span<const ProcessDerivatives>) {
  throw std::logic_error("derivatives of a process with plastic flow");
}

std::string PlasticProcess::description() const {
  return systems_.solver_description() + formatted("; %d sweeps of plastic flow", sweeps_);
}

LockedIn PlasticProcess::gathered(const std::vector<double>& stress,
                                  const std::vector<double>& plastic_strain) const {
  const auto owned = static_cast<std::size_t>(model().part.grid().owned_elements().count());
  const auto spread = [&](const std::vector<double>& share, double factor, std::size_t components,
                          std::size_t c, std::vector<double>& to) {
    const std::vector<double> all = groups().gather(share);
    for (std::size_t e = 0; e < all.size(); ++e)
      to[static_cast<std::size_t>(model().elements[e]) * components + c] = factor * all[e];
  };
  LockedIn result{std::vector<double>(owned * voigt_size<3>, 0.0), std::vector<double>(owned, 0.0)};
  std::vector<double> component(plastic_strain.size());
  for (int c = 0; c < voigt_size<3>; ++c) {
    for (std::size_t e = 0; e < component.size(); ++e) component[e] = stress[e * voigt_size<3> + c];
    spread(component, model().material.young, voigt_size<3>, c, result.stress);
  }
  spread(plastic_strain, 1.0, 1, 0, result.plastic_strain);
  return result;
}

}  // namespace fabseq
