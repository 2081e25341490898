// SPDX-License-Identifier: MIT
#include "fabseq/chain/stages.h"

#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/sequence_kind.h"
#include "fabseq/solve/solvers.h"

namespace fabseq {

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_sequence(const Model<Dim>& model, double tolerance) {
  return make_other_sequence(model, model.sequence_settings, tolerance);
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_other_sequence(const Model<Dim>& model, const SequenceSettings& settings,
                                                   double tolerance) {
  const double height = model.settings.layers.height_of(model.layers->count());
  const auto heat_solver = [&model, tolerance](const SystemDomain& domain, bool lumped) {
    return make_heat_solver(model.settings.solver, model.grid, domain, lumped, tolerance, model.lanes);
  };
  return settings.kind->make(settings, SequenceContext<Dim>{model.part, model.design_support, model.start,
                                                            height > 0.0 ? 1.0 / height : 0.0,
                                                            model.groups.across(), model.lanes, heat_solver});
}

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_baseline_sequence(const Model<Dim>& model) {
  return std::make_unique<GivenSequence<Dim>>(planar_time(model.part, model.settings.baseline.direction));
}

FABSEQ_INSTANTIATE_FUNCTION(make_sequence);
FABSEQ_INSTANTIATE_FUNCTION(make_other_sequence);
FABSEQ_INSTANTIATE_FUNCTION(make_baseline_sequence);

}  // namespace fabseq
