// SPDX-License-Identifier: MIT
#include "fabseq/chain/sequence_stage.h"

#include "fabseq/base/mpi.h"
#include "fabseq/chain/stages.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

/// Memory per node, measured (docs/developer/measuring.md): of the problem with a group's fields, and of its
/// solver, per lane or, on the reference path, all in all.
constexpr double bytes_of_problem = 200.0, bytes_per_lane = 106.0, reference_bytes = 700.0;
/// The forward solve, which one group does for all, in units of a full block of layers.
constexpr double forward_work = 0.1;

StageCost cost_of_sequence(const RunSize& size, SolverPath path, int groups, int lanes) {
  const double solver = path == SolverPath::lanes ? bytes_per_lane * lanes : reference_bytes;
  return {.held = size.nodes * bytes_of_problem * groups,
          .solving = size.nodes * solver * groups,
          .work = forward_work};
}

const RegisteredStage<SequenceStage> sequence_stage{{"sequence", {}, {&Results::time}}, cost_of_sequence};

}  // namespace

template <int Dim>
SequenceStage<Dim>::SequenceStage(StageContext<Dim>& context)
    : groups_(context.model.groups),
      sequence_(context.sequence ? std::move(context.sequence)
                                 : make_sequence(context.model, context.tolerance)) {}

/// Smooth and binary layers of a design share its pseudo-time.
template <int Dim>
void SequenceStage<Dim>::forward(const StageInput& input, StageResults<Dim>& results) {
  const SolveTolerance tolerance = sequence_tolerance(input.tolerance);
  if (!is_solved(input.design.field, tolerance)) {
    solved_.reset();
    sequence_->set_tolerance(tolerance);
    const PseudoTime<Dim>& time = sequence_->update(groups_.gather(input.design.field));
    solved_ = {input.design.field, tolerance, &time};
    iterations_.clear();
    if (time.iterations) iterations_.push_back(*time.iterations);
  }
  results.time = *solved_->time;
}

/// Whether all ranks have the pseudo-time of that design, at least as close.
template <int Dim>
bool SequenceStage<Dim>::is_solved(const std::vector<double>& design, const SolveTolerance& tolerance) const {
  const bool close =
      solved_ && solved_->tolerance.value <= tolerance.value && solved_->tolerance.reach <= tolerance.reach;
  return !any(groups_.world(), !close || design != solved_->design);
}

template <int Dim>
void SequenceStage<Dim>::pull_back(const StageResults<Dim>& /*state*/, const SolveTolerance& tolerance,
                                   AdjointRowSpan<Dim> rows) {
  sequence_->set_tolerance(elasticity_tolerance(tolerance));
  std::vector<TimeDerivatives> times;
  for (AdjointRow<Dim>* row : rows) times.push_back(std::move(row->adjoint.time));
  std::vector<std::vector<double>> fields = sequence_->pull_back(times);
  const std::vector<int> solves = sequence_->adjoint_iterations();
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k]->field = std::move(fields[k]);
  for (std::size_t k = 0; k < solves.size(); ++k) rows[k]->iterations = solves[k];
}

template <int Dim>
void SequenceStage<Dim>::add_iterations(SolverIterations& iterations) const {
  iterations.heat.insert(iterations.heat.end(), iterations_.begin(), iterations_.end());
}

FABSEQ_INSTANTIATE_CLASS(SequenceStage);

}  // namespace fabseq
