// SPDX-License-Identifier: MIT
#include "fabseq/process/elastic_process.h"

#include "process/case_strain.h"
#include "process/elastic_adjoint.h"

#include <utility>

namespace fabseq {

/// Loads of all strain cases, and their increments.
template <int Dim>
class ElasticProcess<Dim>::Forward : public StepLoads {
 public:
  Forward(ElasticProcess& process, const LayerDensities& densities)
      : process_(process), densities_(densities) {}

  std::size_t begin(std::size_t) override { return process_.result_.case_count(); }
  void set(std::size_t block, std::size_t number, LaneVector& load) override {
    process_.systems_.elements().set_load(densities_, process_.systems_.blocks()[block],
                                          CaseStrain<Dim>(*process_.strains_, process_.cases_.cases[number]),
                                          load);
  }
  void take(std::size_t block, std::size_t number, LaneVector& solution) override {
    ProcessResult& result = process_.result_;
    pick(solution, result.nodes[block], result.of_case(number).increments[block]);
  }

 private:
  ElasticProcess& process_;
  const LayerDensities& densities_;
};

template <int Dim>
ElasticProcess<Dim>::ElasticProcess(const ElasticModel<Dim>& model,
                                    std::unique_ptr<ElasticitySolver<Dim>> solver, const LayerGroups& groups,
                                    BlockSolver blocks, int lanes)
    : cases_(strain_cases<Dim>(model.material)),
      superposition_(cases_.cases.size(), cases_.scenarios),
      systems_(model, std::move(solver), groups, blocks, lanes),
      supports_(model),
      adjoint_loads_(systems_) {
  result_.all_layers = groups.world();
  result_.superposition = &superposition_;
  result_.other_cases.resize(superposition_.case_count() - 1);
  if (model.settings.deposition == DepositionModel::nominal)
    deposition_ = std::make_unique<const Deposition<Dim>>(model);
}

template <int Dim>
void ElasticProcess<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  systems_.set_tolerance(tolerance);
  if (release_) release_->set_tolerance(tolerance.value);
}

template <int Dim>
void ElasticProcess<Dim>::start_cold() {
  systems_.start_cold();
  if (release_) release_->start_cold();
}

template <int Dim>
void ElasticProcess<Dim>::release_memory() {
  systems_.release_memory();
  for (std::size_t number = 0; number < result_.case_count(); ++number)
    result_.of_case(number).increments = {};
  result_.weights = {};
}

template <int Dim>
const ProcessResult& ElasticProcess<Dim>::simulate(const LayerDensities& densities,
                                                   const StrainSource<Dim>& strains,
                                                   std::vector<BuildStep> steps) {
  strains_ = &strains;
  result_.blocks.clear();
  result_.nodes.clear();
  systems_.deal_out(densities, std::move(steps));
  result_.steps = systems_.steps();
  for (std::size_t block = 0; block < systems_.blocks().size(); ++block) {
    result_.blocks.push_back(systems_.blocks()[block].block);
    result_.nodes.push_back(systems_.nodes(block));
  }
  for (std::size_t number = 0; number < result_.case_count(); ++number) {
    result_.of_case(number).displacement.assign(model().domain.fixed.size(), 0.0);
    result_.of_case(number).increments.resize(result_.blocks.size());
  }
  result_.weights.resize(deposition_ ? result_.blocks.size() : 0);
  Forward forward(*this, densities);
  result_.iterations = systems_.solve(densities, SolvePurpose::forward, forward);
  groups().run([&] {
    for (std::size_t block = 0; block < result_.blocks.size(); ++block) {
      if (deposition_)
        result_.weights[block] =
            deposition_->weights(densities, result_.steps_of(block), result_.nodes[block]);
      for (std::size_t number = 0; number < result_.case_count(); ++number)
        result_.add_counted(block, result_.of_case(number));
    }
  });
  for (std::size_t number = 0; number < result_.case_count(); ++number)
    groups().sum(result_.of_case(number).displacement);
  for (std::size_t number = 0; release_ && number < result_.case_count(); ++number) {
    const std::vector<double> forces = reactions(densities, number);
    result_.of_case(number).release = in_first_group([&] { return release_->displacement(forces); });
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
std::vector<double> ElasticProcess<Dim>::in_first_group(const std::function<std::vector<double>()>& solve) {
  std::vector<double> result(model().domain.fixed.size());
  groups().run([&] {
    if (groups().index() == 0) result = solve();
  });
  groups().broadcast(0, result);
  return result;
}

template <int Dim>
std::vector<double> ElasticProcess<Dim>::step_increment(int step, bool counted) const {
  const auto place = systems_.place_of(step);
  std::vector<double> result(result_.displacement.size());
  if (place.group == groups().index())
    for (std::size_t i = 0; i < result_.nodes[place.block].size() * Dim; ++i)
      result[result_.in_field(place.block, i, Dim)] = counted
                                                          ? result_.counted(place.block, i, place.lane)
                                                          : result_.increments[place.block](i, place.lane);
  groups().broadcast(place.group, result);
  return result;
}

template <int Dim>
std::vector<double> ElasticProcess<Dim>::layer_increment(int layer, bool counted) const {
  std::vector<double> result(result_.displacement.size(), 0.0);
  for (std::size_t step = 0; step < result_.steps.size(); ++step)
    if (result_.steps[step].layer == layer)
      add_scaled(result, 1.0, step_increment(static_cast<int>(step), counted));
  return result;
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
      all.back().motion = in_first_group([&] { return release_->adjoint(of_release); });
  }
  for (const ProcessDerivatives& own : derivatives)
    if (own.strains != nullptr) own.strains->resize(strains_->input_count(), 0.0);
  adjoint_loads_.update(densities, result_, functionals);
  const ElasticRun<Dim> run{systems_, supports_, deposition_.get(), cases_, densities, *strains_, result_};
  ElasticAdjoint<Dim> adjoint(run, adjoint_loads_, all);
  adjoint_iterations_ = systems_.solve(densities, SolvePurpose::adjoint, adjoint);
}

FABSEQ_INSTANTIATE_CLASS(ElasticProcess);

}  // namespace fabseq
