// SPDX-License-Identifier: MIT
#include "fabseq/layers/curved_layers.h"

#include "fabseq/layers/smooth_step.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

/// Elements on a time point belong to the earlier layer.
constexpr double time_tolerance = 1e-12;

std::vector<double> uniform_time_points(int count) {
  std::vector<double> result;
  for (int j = 0; j <= count; ++j) result.push_back(static_cast<double>(j) / count);
  return result;
}

std::vector<double> interpolated_time_points(std::span<const double> given, int count) {
  std::vector<double> ends = {0.0};
  ends.insert(ends.end(), given.begin(), given.end());
  ends.push_back(1.0);
  const std::vector<double> uniform = uniform_time_points(count);
  std::vector<double> points(uniform.begin() + 1, uniform.end() - 1);
  for (double& point : points) {
    const double place = point * static_cast<double>(ends.size() - 1);
    const auto last = std::min(static_cast<std::size_t>(place + 1e-9), ends.size() - 2);
    point = std::lerp(ends[last], ends[last + 1], place - static_cast<double>(last));
  }
  return points;
}

CurvedLayers::CurvedLayers(std::span<const double> density, std::vector<double> time_points, double beta,
                           bool binary)
    : density_(density), time_points_(std::move(time_points)), beta_(beta), binary_(binary) {}

void CurvedLayers::set_densities(std::span<const double> time, LayerDensities& densities) const {
  densities.time_points = time_points_;
  densities.sub_parts = {};
  densities.stage.resize(count());
  densities.layer.resize(count());
  for (int j = 0; j < count(); ++j) {
    auto& stage = densities.stage[j];
    stage.assign(density_.begin(), density_.end());
    if (j + 1 < count()) apply_step(time, time_points_[j + 1], stage);
    densities.layer[j] = stage;
    for (std::size_t e = 0; j > 0 && e < stage.size(); ++e)
      densities.layer[j][e] -= densities.stage[j - 1][e];
  }
}

void CurvedLayers::apply_step(std::span<const double> time, double time_point,
                              std::span<double> stage) const {
  if (binary_) {
    for (std::size_t e = 0; e < stage.size(); ++e)
      if (!(time[e] <= time_point + time_tolerance)) stage[e] = 0.0;
    return;
  }
  const SmoothStep step(time_point, beta_);
  for (std::size_t e = 0; e < stage.size(); ++e) stage[e] *= step.value(time[e]);
}

void CurvedLayers::pull_back(std::span<const double> time, const LayerDensities& /*densities*/,
                             const DensityDerivatives& derivatives, std::span<double> d_time,
                             std::span<double> d_variables) const {
  const std::vector<double>& explicit_ones = derivatives.time_points;  // by T_0 ... T_N
  for (std::size_t j = 0; j < d_variables.size() && !explicit_ones.empty(); ++j)
    d_variables[j] += explicit_ones[j + 1];
  if (!binary_) pull_back_steps(time, derivatives, d_time, d_variables);
}

void CurvedLayers::pull_back_steps(std::span<const double> time, const DensityDerivatives& derivatives,
                                   std::span<double> d_time, std::span<double> d_variables) const {
  std::vector<double> weight(density_.size());
  const auto add = [&weight](const std::vector<double>& derivative, double sign) {
    for (std::size_t e = 0; e < derivative.size(); ++e) weight[e] += sign * derivative[e];
  };
  // The last stage is the whole part, whatever the time.
  for (int j = 0; j + 1 < count(); ++j) {
    const auto& stage = derivatives.stage[j];
    const auto& ends = derivatives.layer[j];        // layer j ends with stage j
    const auto& begins = derivatives.layer[j + 1];  // and layer j + 1 begins there
    if (stage.empty() && ends.empty() && begins.empty()) continue;
    std::fill(weight.begin(), weight.end(), 0.0);
    add(stage, 1.0);
    add(ends, 1.0);
    add(begins, -1.0);
    const SmoothStep step(time_points_[j + 1], beta_);
    for (std::size_t e = 0; e < weight.size(); ++e)
      d_time[e] += weight[e] * density_[e] * step.derivative(time[e]);
    if (d_variables.empty()) continue;
    double sum = 0.0;
    for (std::size_t e = 0; e < weight.size(); ++e)
      sum += weight[e] * density_[e] * step.time_point_derivative(time[e]);
    d_variables[j] += sum;
  }
}

std::vector<double> CurvedLayers::layer_index(std::span<const double> time,
                                              const LayerDensities& /*densities*/) const {
  // Variable time points may be out of order: what counts is the latest so far.
  std::vector<double> latest(time_points_.begin() + 1, time_points_.end());
  for (std::size_t j = 1; j < latest.size(); ++j) latest[j] = std::max(latest[j], latest[j - 1]);
  std::vector<double> result;
  for (const double t : time) {
    const auto layer = std::lower_bound(latest.begin(), latest.end(), t - time_tolerance) - latest.begin();
    result.push_back(std::min(static_cast<double>(layer) + 1.0, static_cast<double>(latest.size())));
  }
  return result;
}

}  // namespace fabseq
