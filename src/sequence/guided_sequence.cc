// SPDX-License-Identifier: MIT
#include "sequence/guided_sequence.h"

#include "fabseq/sequence/element_means.h"
#include "sequence/guided_start.h"

#include <cmath>
#include <utility>

namespace fabseq {

template <int Dim>
GuidedSequence<Dim>::GuidedSequence(const Part<Dim>& part, const GuidedSettings& settings,
                                    std::unique_ptr<GuidedProblem<Dim>> problem)
    : part_(part),
      settings_(settings),
      problem_(std::move(problem)),
      tilts_(part.plate()),
      filter_(part, settings.filter_radius.value()) {}

template <int Dim>
std::vector<double> GuidedSequence<Dim>::initial_design() const {
  std::vector<double> design = guided_start(part_, settings_, problem_->element());
  // A filtered design stays within its bounds: the filter takes means.
  return settings_.start == GuidedStart::distance ? filtered(design, &AveragingFilter<Dim>::apply) : design;
}

/// The filter, or its transpose, of each component.
template <int Dim>
std::vector<double> GuidedSequence<Dim>::filtered(std::span<const double> design, Filter filter) const {
  const auto components = static_cast<std::size_t>(settings_.components(Dim));
  std::vector<double> result(design.size()), field(part_.elements().size());
  for (std::size_t c = 0; c < components; ++c) {
    for (std::size_t e = 0; e < field.size(); ++e) field[e] = design[e * components + c];
    const std::vector<double> means = (filter_.*filter)(field);
    for (std::size_t e = 0; e < field.size(); ++e) result[e * components + c] = means[e];
  }
  return result;
}

/// e^-s / l_c, the length of v.
template <int Dim>
double GuidedSequence<Dim>::density_of_layers(std::size_t element) const {
  const int components = settings_.components(Dim);
  const double stretch = settings_.stretch ? guide_[element * components + components - 1] : 0.0;
  return std::exp(-stretch) / settings_.characteristic_length.value();
}

template <int Dim>
const PseudoTime<Dim>& GuidedSequence<Dim>::update(std::span<const double> design) {
  guide_ = filtered(design, &AveragingFilter<Dim>::apply);
  const int components = settings_.components(Dim);
  std::vector<double> vectors;
  for (std::size_t e = 0; e < part_.elements().size(); ++e) {
    const double length = density_of_layers(e);
    for (const double component : tilts_.direction(&guide_[e * components]))
      vectors.push_back(length * component);
  }
  time_.nodal = problem_->times(vectors);
  time_.iterations = problem_->iterations();
  const std::vector<double> ghosted = part_.grid().exchange(1).ghosted(time_.nodal);
  ElementMeans means = element_means<Dim>(part_, problem_->element(), ghosted);
  time_.time = std::move(means.mean);
  time_.gradient = std::move(means.gradient);
  return time_;
}

template <int Dim>
std::vector<std::vector<double>> GuidedSequence<Dim>::pull_back(std::span<const TimeDerivatives> rows) {
  std::vector<std::vector<double>> result;
  for (const std::vector<double>& d_vectors : problem_->pull_back(rows))
    result.push_back(filtered(by_design(d_vectors), &AveragingFilter<Dim>::apply_transpose));
  return result;
}

/// Derivative with respect to the filtered design, from that with respect to v: v goes with e^-s, so that
/// dv/ds = -v.
template <int Dim>
std::vector<double> GuidedSequence<Dim>::by_design(const std::vector<double>& d_vectors) const {
  const int components = settings_.components(Dim);
  std::vector<double> result(guide_.size());
  for (std::size_t e = 0; e < part_.elements().size(); ++e) {
    const double length = density_of_layers(e);
    Point<Dim> d_direction;
    for (int axis = 0; axis < Dim; ++axis) d_direction[axis] = length * d_vectors[e * Dim + axis];
    const double* tilt = &guide_[e * components];
    tilts_.add_derivative(tilt, d_direction, &result[e * components]);
    if (settings_.stretch)
      result[e * components + components - 1] -= dot(d_direction, tilts_.direction(tilt));
  }
  return result;
}

FABSEQ_INSTANTIATE_CLASS(GuidedSequence);

}  // namespace fabseq
