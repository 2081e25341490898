// SPDX-License-Identifier: MIT
#include "fabseq/process/superposition.h"
#include "responses/distortion_measures.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

/// A distortion of the scenarios' displacements, which are combinations of the strain cases.
template <int Dim>
class OfScenarios {
 public:
  OfScenarios(std::shared_ptr<const Response<Dim>> distortion, bool of_increments)
      : distortion_(std::move(distortion)), of_increments_(of_increments) {}

  const Response<Dim>& distortion() const { return *distortion_; }

  /// J for a combination of the cases.
  double value(const std::vector<double>& combination, const StageResults<Dim>& state) const {
    const ProcessResult process =
        state.process->superposition->combined(*state.process, combination, of_increments_);
    return distortion_->values({state.time, state.densities, process})[0];
  }
  void add_derivative(const std::vector<double>& combination, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const {
    const ProcessResult process =
        state.process->superposition->combined(*state.process, combination, of_increments_);
    StageDerivatives<Dim> own(state.densities->count());
    distortion_->add_derivative(0, weight, {state.time, state.densities, process}, own);
    own.process.combination = combination;
    adjoint.process.combinations.push_back(std::move(own.process));
  }

 private:
  std::shared_ptr<const Response<Dim>> distortion_;
  bool of_increments_;
};

/// J of each scenario.
template <int Dim>
class EachScenario : public Response<Dim> {
 public:
  explicit EachScenario(OfScenarios<Dim> scenarios) : scenarios_(std::move(scenarios)) {}

  bool uses_displacements() const override { return true; }
  std::vector<double> values(const StageResults<Dim>& state) const override {
    std::vector<double> result;
    for (const auto& combination : state.process->superposition->scenarios())
      result.push_back(scenarios_.value(combination, state));
    return result;
  }
  void add_derivative(int component, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    scenarios_.add_derivative(state.process->superposition->scenarios()[component], weight, state, adjoint);
  }

 private:
  OfScenarios<Dim> scenarios_;
};

/// The largest of them; its derivative is that of the first that is largest.
template <int Dim>
class WorstScenario : public Response<Dim> {
 public:
  explicit WorstScenario(OfScenarios<Dim> scenarios) : each_(std::move(scenarios)) {}

  bool uses_displacements() const override { return true; }
  std::vector<double> values(const StageResults<Dim>& state) const override {
    const std::vector<double> all = each_.values(state);
    return {*std::max_element(all.begin(), all.end())};
  }
  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const std::vector<double> all = each_.values(state);
    const auto largest = std::max_element(all.begin(), all.end()) - all.begin();
    each_.add_derivative(static_cast<int>(largest), weight, state, adjoint);
  }
  std::unique_ptr<Response<Dim>> largest_of() const override {
    return std::make_unique<EachScenario<Dim>>(each_);
  }

 private:
  EachScenario<Dim> each_;
};

/// Mean of J over the scenarios, or over their deviations from their mean.
template <int Dim>
class MeanOfScenarios : public Response<Dim> {
 public:
  MeanOfScenarios(OfScenarios<Dim> scenarios, bool of_deviations)
      : scenarios_(std::move(scenarios)), of_deviations_(of_deviations) {}

  bool uses_displacements() const override { return true; }
  std::vector<double> values(const StageResults<Dim>& state) const override {
    const auto all = combinations(state);
    double total = 0.0;
    for (const auto& combination : all) total += scenarios_.value(combination, state);
    return {total / static_cast<double>(all.size())};
  }
  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const auto all = combinations(state);
    for (const auto& combination : all)
      scenarios_.add_derivative(combination, weight / static_cast<double>(all.size()), state, adjoint);
  }

 private:
  std::vector<std::vector<double>> combinations(const StageResults<Dim>& state) const {
    std::vector<std::vector<double>> result = state.process->superposition->scenarios();
    if (!of_deviations_) return result;
    std::vector<double> mean(result.front().size(), 0.0);
    for (const auto& combination : result)
      for (std::size_t k = 0; k < mean.size(); ++k)
        mean[k] += combination[k] / static_cast<double>(result.size());
    for (auto& combination : result)
      for (std::size_t k = 0; k < mean.size(); ++k) combination[k] -= mean[k];
    return result;
  }

  OfScenarios<Dim> scenarios_;
  bool of_deviations_;
};

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> aggregated(std::unique_ptr<Response<Dim>> distortion, Aggregate aggregate,
                                          bool of_increments) {
  if (aggregate == Aggregate::nominal) return distortion;
  OfScenarios<Dim> scenarios(std::move(distortion), of_increments);
  if (aggregate == Aggregate::worst) return std::make_unique<WorstScenario<Dim>>(std::move(scenarios));
  return std::make_unique<MeanOfScenarios<Dim>>(std::move(scenarios), aggregate == Aggregate::spread);
}

FABSEQ_INSTANTIATE_FUNCTION(aggregated);

}  // namespace fabseq
