// SPDX-License-Identifier: MIT
#include "repair/place_limit.h"

#include "fabseq/base/mpi.h"
#include "fabseq/report/build_class.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace fabseq {

namespace {

/// Growth of an element's weight after each step that leaves it failing.
constexpr double growth = 1.1;

}  // namespace

template <int Dim>
std::optional<PlaceLimit<Dim>> PlaceLimit<Dim>::of(const Model<Dim>& model, Fault fault) {
  const ToolSettings& tool = model.settings.tool;
  if (fault == Fault::tilt && !tool.axis.empty()) return std::nullopt;
  if (fault == Fault::blocked && tool.profile.empty()) return std::nullopt;
  if (fault == Fault::local_thickness && !model.settings.layers.target) return std::nullopt;
  for (const ResponseType* type : response_types(TermList::constraints))
    if (type->exact_check == name_of(fault)) return PlaceLimit(model, *type);
  return std::nullopt;
}

template <int Dim>
PlaceLimit<Dim>::PlaceLimit(const Model<Dim>& model, const ResponseType& type)
    : comm_(model.grid.comm()),
      weights_(std::make_unique<std::vector<double>>(model.part.elements().size(), 0.0)) {
  ResponseContext<Dim> context = model.context();
  context.element_weights = weights_.get();
  Term term;
  term.type = &type;
  term.own = type.defaults();
  response_ = type.make(term, context);
}

template <int Dim>
void PlaceLimit<Dim>::forget() {
  std::fill(weights_->begin(), weights_->end(), 0.0);
  scale_ = 0.0;
}

template <int Dim>
void PlaceLimit<Dim>::count(std::span<const double> failing) {
  failing_weight_ = 0.0;
  for (std::size_t e = 0; e < failing.size(); ++e)
    if (failing[e] > 0.0) {
      double& weight = (*weights_)[e];
      weight = std::max(1.0, growth * weight);
      failing_weight_ += weight;
    }
  failing_weight_ = sum(comm_, failing_weight_);
}

template <int Dim>
double PlaceLimit<Dim>::value(const CutTime<Dim>& cut) {
  const ProcessResult nothing;  // smooth counts know of no displacements
  const std::vector<double> values = response_->values({cut.time, cut.densities, nothing});
  components_ = values.size();
  const double total = std::accumulate(values.begin(), values.end(), 0.0);
  if (scale_ == 0.0 && failing_weight_ > 0.0) scale_ = failing_weight_ / total;
  return scale_ * total;
}

template <int Dim>
void PlaceLimit<Dim>::add_derivatives(const CutTime<Dim>& cut, TimeDerivatives& derivatives) const {
  if (scale_ == 0.0) return;
  const ProcessResult nothing;
  const StageResults<Dim> state{cut.time, cut.densities, nothing};
  StageDerivatives<Dim> adjoint(cut.densities.count());
  for (std::size_t c = 0; c < components_; ++c)
    response_->add_derivative(static_cast<int>(c), scale_, state, adjoint);
  for (std::size_t i = 0; i < adjoint.time.time.size(); ++i) derivatives.time[i] += adjoint.time.time[i];
  for (std::size_t i = 0; i < adjoint.time.gradient.size(); ++i)
    derivatives.gradient[i] += adjoint.time.gradient[i];
}

FABSEQ_INSTANTIATE_CLASS(PlaceLimit);

}  // namespace fabseq
