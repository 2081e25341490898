#include "fabseq/layers/curved_layers.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Elements on a time point belong to the earlier layer.
constexpr double time_tolerance = 1e-12;

/// Smooth step from 1 before time point T to 0 after it, exactly 1 at t = 0 and 0 at t = 1.
class StepDown {
 public:
  StepDown(double time_point, double beta)
      : time_point_(time_point),
        beta_(beta),
        start_(std::tanh(beta * time_point)),
        scale_(1.0 / (start_ + std::tanh(beta * (1.0 - time_point)))) {}

  double value(double time) const {
    return 1.0 - (start_ + std::tanh(beta_ * (time - time_point_))) * scale_;
  }
  double derivative(double time) const {
    const double hyperbolic = std::tanh(beta_ * (time - time_point_));
    return -beta_ * (1.0 - hyperbolic * hyperbolic) * scale_;
  }

 private:
  double time_point_, beta_, start_, scale_;
};

}  // namespace

CurvedLayers::CurvedLayers(std::span<const double> density, int count, double beta, bool binary)
    : density_(density), beta_(beta), binary_(binary) {
  for (int j = 0; j <= count; ++j) time_points_.push_back(static_cast<double>(j) / count);
}

LayerDensities CurvedLayers::densities(std::span<const double> time) const {
  const std::size_t elements = density_.size();
  LayerDensities result;
  result.time_points = time_points_;
  result.stage.resize(count());
  result.layer.resize(count());
  for (int j = 0; j < count(); ++j) {
    auto& stage = result.stage[j];
    stage.assign(density_.begin(), density_.end());
    if (j + 1 < count()) {
      const double time_point = time_points_[j + 1];
      const StepDown step(time_point, beta_);
      for (std::size_t e = 0; e < elements; ++e)
        stage[e] *= binary_ ? (time[e] <= time_point + time_tolerance ? 1.0 : 0.0) : step.value(time[e]);
    }
    result.layer[j] = stage;
    for (std::size_t e = 0; j > 0 && e < elements; ++e) result.layer[j][e] -= result.stage[j - 1][e];
  }
  return result;
}

void CurvedLayers::pull_back(std::span<const double> time, const DensityDerivatives& derivatives,
                             std::span<double> d_time) const {
  if (binary_) return;
  // The last stage is the whole part, whatever the time.
  for (int j = 0; j + 1 < count(); ++j) {
    const auto& stage = derivatives.stage[j];
    const auto& ends = derivatives.layer[j];        // layer j ends with stage j
    const auto& begins = derivatives.layer[j + 1];  // and layer j + 1 begins there
    if (stage.empty() && ends.empty() && begins.empty()) continue;
    const StepDown step(time_points_[j + 1], beta_);
    for (std::size_t e = 0; e < density_.size(); ++e) {
      const double weight = (stage.empty() ? 0.0 : stage[e]) + (ends.empty() ? 0.0 : ends[e]) -
                            (begins.empty() ? 0.0 : begins[e]);
      if (weight != 0.0) d_time[e] += weight * density_[e] * step.derivative(time[e]);
    }
  }
}

std::vector<double> layer_index(std::span<const double> time, int count) {
  std::vector<double> result(time.size());
  for (std::size_t e = 0; e < time.size(); ++e) {
    const double layer = std::ceil((time[e] - time_tolerance) * count);
    result[e] = std::clamp(layer, 1.0, static_cast<double>(count));
  }
  return result;
}

}  // namespace fabseq
