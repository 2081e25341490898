// SPDX-License-Identifier: MIT
#include "fabseq/process/elastic_process.h"

#include "fabseq/process/residual_stress.h"
#include "process/case_strain.h"
#include "process/elastic_adjoint.h"
#include "process/step_results.h"

#include <utility>

namespace fabseq {

/// Loads of all strain cases, and their increments.
template <int Dim>
class ElasticProcess<Dim>::Forward : public StepLoads {
 public:
  Forward(ElasticProcess& process, const LayerDensities& densities)
      : process_(process), densities_(densities) {}

  std::size_t begin(std::size_t block) override {
    process_.result_.nodes[block] = process_.systems_.nodes(block);
    return process_.result_.case_count();
  }
  void set(std::size_t block, std::size_t number, LaneVector& load) override {
    process_.systems_.elements().set_load(densities_, process_.systems_.blocks()[block],
                                          CaseStrain<Dim>(*process_.strains_, process_.cases_.cases[number]),
                                          load);
  }
  void take(std::size_t block, std::size_t number, LaneVector& solution) override {
    ProcessResult& result = process_.result_;
    pick(solution, result.nodes[block], result.of_case(number).increments[block]);
  }
  void end(std::size_t block) override {
    count_block(process_.deposition_.get(), densities_, block, process_.result_);
  }

 private:
  ElasticProcess& process_;
  const LayerDensities& densities_;
};

template <int Dim>
ElasticProcess<Dim>::ElasticProcess(const ElasticModel<Dim>& model,
                                    std::unique_ptr<ElasticitySolver<Dim>> solver, const LayerGroups& groups,
                                    BlockSolver blocks, int lanes)
    : Process<Dim>(model, std::move(solver), groups, blocks, lanes),
      cases_(strain_cases<Dim>(model.material)),
      superposition_(cases_.cases.size(), cases_.scenarios),
      supports_(model),
      adjoint_loads_(systems_) {
  result_.superposition = &superposition_;
  result_.other_cases.resize(superposition_.case_count() - 1);
}

template <int Dim>
const ProcessResult& ElasticProcess<Dim>::simulate(const ProcessInput<Dim>& input) {
  strains_ = &input.strains;
  systems_.deal_out(input.densities, input.steps);
  set_steps(systems_, result_);
  Forward forward(*this, input.densities);
  result_.iterations = systems_.solve(input.densities, SolvePurpose::forward, forward);
  sum_displacements(groups(), result_);
  for (std::size_t number = 0; release_ && number < result_.case_count(); ++number) {
    const std::vector<double> forces = reactions(input.densities, number);
    result_.of_case(number).release =
        groups().from_first(forces.size(), [&] { return release_->displacement(forces); });
  }
  return result_;
}

template <int Dim>
std::vector<double> ElasticProcess<Dim>::reactions(const LayerDensities& densities,
                                                   std::size_t number) const {
  std::vector<double> result(model().domain.fixed.size(), 0.0);
  LaneVector increments;
  for (std::size_t block = 0; block < result_.blocks.size(); ++block) {
    spread(result_.of_case(number).increments[block], result_.nodes[block], systems_.owned_nodes(),
           increments);
    supports_.add_reactions(densities, CaseStrain<Dim>(*strains_, cases_.cases[number]),
                            systems_.blocks()[block], increments, result);
  }
  groups().sum(result);
  return result;
}

template <int Dim>
std::vector<double> ElasticProcess<Dim>::release_displacement(const LayerDensities& densities,
                                                              const ReleaseSolver& solver) const {
  if (!result_.release.empty()) return result_.release;
  const std::vector<double> forces = reactions(densities);
  std::vector<double> result;
  groups().run([&] { result = Release<Dim>(model(), solver).displacement(forces); });
  return result;
}

template <int Dim>
LockedIn ElasticProcess<Dim>::locked_in(const LayerDensities& densities) const {
  return {residual_stress(*this, densities), {}};
}

template <int Dim>
LockedIn ElasticProcess<Dim>::released(LockedIn built, std::span<const double> release) const {
  add_scaled(built.stress, 1.0, finished_stress(model(), release));
  return built;
}

template <int Dim>
void ElasticProcess<Dim>::pull_back(const LayerDensities& densities,
                                    std::span<const ProcessAdjoint> functionals,
                                    std::span<const ProcessDerivatives> derivatives) {
  std::vector<ElasticFunctional> all;
  for (std::size_t i = 0; i < functionals.size(); ++i) {
    const std::vector<double>& of_release = functionals[i].release;
    all.push_back({&functionals[i], &derivatives[i], {}});
    if (!of_release.empty())
      all.back().motion =
          groups().from_first(of_release.size(), [&] { return release_->adjoint(of_release); });
  }
  for (const ProcessDerivatives& own : derivatives)
    if (own.strains != nullptr) own.strains->resize(strains_->input_count(), 0.0);
  adjoint_loads_.update(densities, result_, functionals);
  const ElasticRun<Dim> run{systems_,  supports_, deposition_.get(), cases_,
                            densities, *strains_, result_,           systems_.scratch()};
  ElasticAdjoint<Dim> adjoint(run, adjoint_loads_, all);
  adjoint_iterations_ = systems_.solve(densities, SolvePurpose::adjoint, adjoint);
}

FABSEQ_INSTANTIATE_CLASS(ElasticProcess);

}  // namespace fabseq
