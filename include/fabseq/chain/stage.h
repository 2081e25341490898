// SPDX-License-Identifier: MIT
/// \file
/// The stages of the pipeline: one interface, and the registry from which a chain is made. A stage registers
/// itself in its own source, with the results that it reads and makes; their order follows.
#pragma once

#include "fabseq/base/phase_timer.h"
#include "fabseq/chain/adjoint_rows.h"
#include "fabseq/chain/design.h"
#include "fabseq/files/checkpoint_state.h"
#include "fabseq/model/model.h"
#include "fabseq/model/stage_cost.h"
#include "fabseq/responses/stage_derivatives.h"
#include "fabseq/responses/stage_results.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/solve/solve_tolerance.h"

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// What all stages get on the way forward.
struct StageInput {
  const Design& design;
  double beta;               ///< sharpness of the layers (LayerModel::make())
  bool binary;               ///< sharp layers
  SolveTolerance tolerance;  ///< of a run's solves
  SolverRegion region;       ///< elements of elastic and thermal systems
};

/// Solver iterations of the last run and of the last gradients.
struct SolverIterations {
  std::vector<int> primal, adjoint, heat;
  std::vector<int> temperature;  ///< of each layer's steps, their sum; empty without a block `thermal`
};

/// A link of the chain, differentiated by hand. forward(), pull_back() and start_cold() are collective on the
/// world of the model's groups, the other calls are local.
template <int Dim>
class Stage {
 public:
  virtual ~Stage() = default;

  /// Makes the stage's results from those of the stages before. They stay valid until the next call.
  virtual void forward(const StageInput& input, StageResults<Dim>& results) = 0;
  /// Applies the transposed Jacobian: maps each row's derivatives with respect to this stage's results to
  /// derivatives with respect to its inputs, and adds them. Solves go to `tolerance`. Rows that are not
  /// shared have none with respect to the process or the strains.
  virtual void pull_back(const StageResults<Dim>& state, const SolveTolerance& tolerance,
                         AdjointRowSpan<Dim> rows) = 0;
  /// Whether a row goes back through the stage in its owner's group alone: pull_back() is then collective on
  /// the grid's communicator. Such stages come first.
  virtual bool runs_in_owner_group() const { return false; }
  /// What its time counts for.
  virtual Phase phase() const = 0;
  virtual Phase adjoint_phase() const { return phase(); }
  /// Forgets what earlier solves have left for later ones.
  virtual void start_cold() {}
  /// Gives back memory that the next forward() takes again.
  virtual void release_memory() {}
  /// What start_cold() leaves and a continued run needs, under names of the stage's own.
  virtual void save(CheckpointState& /*state*/) const {}
  virtual void restore(const CheckpointState& /*state*/) {}
  /// Adds the iterations of the last forward() and of the pull_back() behind it.
  virtual void add_iterations(SolverIterations& /*iterations*/) const {}
};

/// What stages are made of. References must outlive them.
template <int Dim>
struct StageContext {
  const Model<Dim>& model;
  const LayerModel<Dim>& layers;
  double tolerance;                         ///< of the run (solve_tolerance.h)
  std::unique_ptr<Sequence<Dim>> sequence;  ///< becomes the stage's; null: the one that the model asks for
};

/// A result of a stage, told by the member of StageResults that holds it.
class ResultName {
 public:
  template <class Result>
  ResultName(
      StageResult<Result> StageResults<3>::*member) {  // NOLINT(google-explicit-constructor): a list of them
    const StageResults<3> any;
    place_ = reinterpret_cast<const char*>(&(any.*member)) - reinterpret_cast<const char*>(&any);
  }
  bool operator==(const ResultName&) const = default;

 private:
  std::ptrdiff_t place_;
};
using Results = StageResults<3>;  ///< for the names of results, the same in 2D

/// What is known of a type of stage.
struct StageTraits {
  std::string name;
  std::vector<ResultName> reads, makes;
};

/// A type of stage.
class StageType : public StageTraits {
 public:
  explicit StageType(StageTraits traits) : StageTraits(std::move(traits)) {}
  StageType(const StageType&) = delete;
  StageType& operator=(const StageType&) = delete;
  virtual ~StageType() = default;

  /// The stage, or null where the model needs none. Collective on the world of the model's groups.
  virtual std::unique_ptr<Stage<2>> make(StageContext<2>& context) const = 0;
  virtual std::unique_ptr<Stage<3>> make(StageContext<3>& context) const = 0;
};

/// All types, each behind those whose results it reads. One that reads what it makes changes it: it comes
/// between the one that makes it and the others that read it.
std::vector<const StageType*> stage_types();
/// Adds a type, which must live as long as the program. RegisteredStage calls it.
void register_stage(const StageType* type);
/// The stages that a model needs, in order. Collective on the world of the model's groups.
template <int Dim>
std::vector<std::unique_ptr<Stage<Dim>>> make_stages(StageContext<Dim> context);

/// Registers a stage. The stage's source defines one object of this type.
///   - Kind<Dim>: the stage, with a static function make(StageContext<Dim>&), or a constructor with this
///     argument;
///   - cost: what it costs.
template <template <int> class Kind>
class RegisteredStage : public StageType {
 public:
  RegisteredStage(StageTraits traits, CostOfStage cost) : StageType(std::move(traits)) {
    register_stage(this);
    register_stage_cost(name, cost);
  }

  std::unique_ptr<Stage<2>> make(StageContext<2>& context) const override { return make_kind<2>(context); }
  std::unique_ptr<Stage<3>> make(StageContext<3>& context) const override { return make_kind<3>(context); }

 private:
  template <int Dim>
  static std::unique_ptr<Stage<Dim>> make_kind(StageContext<Dim>& context) {
    if constexpr (requires { Kind<Dim>::make(context); })
      return Kind<Dim>::make(context);
    else
      return std::make_unique<Kind<Dim>>(context);
  }
};

}  // namespace fabseq
