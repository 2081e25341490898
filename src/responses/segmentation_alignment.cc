// SPDX-License-Identifier: MIT
/// Objective: lines between sub-parts are to be short and perpendicular to the print direction of the next
/// sub-part (docs/formulation.md 7).
#include "fabseq/base/mpi.h"
#include "fabseq/layers/smooth_step.h"
#include "fabseq/responses/response_type.h"

#include <array>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

/// Sharpness k3 of the band's edges.
constexpr double sharpness = 100.0;
/// Regularization, which is added to |grad t|^2, 1/length^2.
constexpr double regularization = 1e-9;

struct SegmentationAlignmentSettings {
  double band = 0.1;

  void check(const TermPlace& place) const {
    for (const double timestamp : place.layers.multi_planar->timestamps)
      if (timestamp + band >= 1.0)
        refuse(pointer_to(place.pointer, "band"), shown(band) + " after the timestamp " + shown(timestamp),
               "a band that ends before 1");
  }
};

/// One component: sum_{i < N_P} sum_e rho_e E_B (v . n_{i+1} + 1). E_B marks the elements up to `band` in
/// pseudo-time after timestamp i, and v = -grad t / |grad t|. NaN without sub-parts.
template <int Dim>
class SegmentationAlignment : public Response<Dim> {
 public:
  SegmentationAlignment(const ResponseContext<Dim>& context, const SegmentationAlignmentSettings& settings)
      : part_(context.part), band_(settings.band) {}

  double size() const override { return static_cast<double>(part_.count()); }

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const SubParts& sub_parts = state.densities->sub_parts;
    if (sub_parts.count() == 0) return {std::numeric_limits<double>::quiet_NaN()};  // the planar baseline
    double total = 0.0;
    for (std::size_t i = 0; i < sub_parts.timestamps.size(); ++i) {
      const Band band(sub_parts.timestamps[i], band_);
      for (std::size_t e = 0; e < state.time->time.size(); ++e)
        total += part_.part_density()[e] * band.value(state.time->time[e]) *
                 (1.0 - along(state, i, e, gradient_length(state, e)));
    }
    return {sum(part_.grid().comm(), total)};
  }

  /// Uses g = grad t and s = sqrt(|g|^2 + eps): d(g . n / s) = (n - (g . n) g / s^2) . dg / s + g . dn / s.
  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const SubParts& sub_parts = state.densities->sub_parts;
    const std::size_t elements = state.time->time.size();
    auto& d_time = DensityDerivatives::zeros_if_empty(adjoint.time.time, elements);
    auto& d_gradient = DensityDerivatives::zeros_if_empty(adjoint.time.gradient, elements * Dim);
    auto& d_directions = adjoint.densities.directions_or_zeros(sub_parts);
    for (std::size_t i = 0; i < sub_parts.timestamps.size(); ++i) {
      const Band band(sub_parts.timestamps[i], band_);
      for (std::size_t e = 0; e < elements; ++e) {
        const double density = weight * part_.part_density()[e];
        const double length = gradient_length(state, e), cosine = along(state, i, e, length);
        d_time[e] += density * band.derivative(state.time->time[e]) * (1.0 - cosine);
        const double factor = -density * band.value(state.time->time[e]) / length;
        for (int axis = 0; axis < Dim; ++axis) {
          const double g = state.time->gradient[e * Dim + axis];
          d_gradient[e * Dim + axis] += factor * (next_direction(sub_parts, i)[axis] - cosine * g / length);
          d_directions[(i + 1) * Dim + axis] += factor * g;
        }
      }
    }
  }

 private:
  /// E_B as a smooth function of pseudo-time: 1 between a timestamp and the end of its band, 0 elsewhere.
  class Band {
   public:
    Band(double timestamp, double width) : begin_(timestamp, sharpness), end_(timestamp + width, sharpness) {}
    double value(double time) const { return end_.value(time) - begin_.value(time); }
    double derivative(double time) const { return end_.derivative(time) - begin_.derivative(time); }

   private:
    SmoothStep begin_, end_;
  };

  static const double* next_direction(const SubParts& sub_parts, std::size_t timestamp) {
    return &sub_parts.directions[(timestamp + 1) * Dim];
  }
  static double gradient_length(const StageResults<Dim>& state, std::size_t element) {
    double square = regularization;
    for (int axis = 0; axis < Dim; ++axis) square += std::pow(state.time->gradient[element * Dim + axis], 2);
    return std::sqrt(square);
  }
  /// -v . n_{i+1}: cosine of the angle between grad t and the next print direction.
  static double along(const StageResults<Dim>& state, std::size_t timestamp, std::size_t element,
                      double length) {
    double product = 0.0;
    for (int axis = 0; axis < Dim; ++axis)
      product += state.time->gradient[element * Dim + axis] *
                 next_direction(state.densities->sub_parts, timestamp)[axis];
    return product / length;
  }

  const Part<Dim>& part_;
  double band_;
};

const Registered<SegmentationAlignment, SegmentationAlignmentSettings> registered(
    {.name = "segmentation_alignment", .layers = LayerKind::multi_planar, .needs_time_gradient = true},
    Section<SegmentationAlignmentSettings>("objective")
        .key("band", &SegmentationAlignmentSettings::band, "Width in pseudo-time of the band after each line",
             {.range = "(0, 1)"}));

}  // namespace

}  // namespace fabseq
