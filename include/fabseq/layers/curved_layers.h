/// \file
/// Pseudo-time to layers: which elements each stage holds and each layer adds (docs/formulation.md 3.1).
#pragma once

#include <span>
#include <vector>

namespace fabseq {

/// Added to a layer's density wherever it is a weight, so that empty layers stay finite.
constexpr double layer_density_floor = 1e-9;

/// Densities of all stages and layers on the part elements. Layer j of the text is entry j - 1.
struct LayerDensities {
  std::vector<double> time_points;         ///< T_0 = 0 ... T_N = 1
  std::vector<std::vector<double>> stage;  ///< [layer][part element]: what stands once the layer is built
  std::vector<std::vector<double>> layer;  ///< [layer][part element]: what the layer adds

  int count() const { return static_cast<int>(layer.size()); }
};

/// A response's derivative with respect to what LayerDensities holds; what nobody touched stays empty.
struct DensityDerivatives {
  std::vector<std::vector<double>> stage,
      layer;                        ///< like LayerDensities, or empty for a layer without derivative
  std::vector<double> time_points;  ///< explicit dependence on T_0 ... T_N; the same on all ranks

  explicit DensityDerivatives(int layers) : stage(layers), layer(layers) {}
  /// The entries of the time points, zeros at first use.
  std::vector<double>& touch_time_points() { return touch(time_points, stage.size() + 1); }
  /// The entries of a layer, zeros at first use.
  static std::vector<double>& touch(std::vector<double>& entries, std::size_t elements) {
    if (entries.empty()) entries.assign(elements, 0.0);
    return entries;
  }
};

/// T_j = j / count: T_0 = 0 ... T_N = 1.
std::vector<double> uniform_time_points(int count);

/// The smooth (or binary) step between stages.
class CurvedLayers {
 public:
  /// `density`: of the part elements; not owned, must outlive the object. `time_points`: T_0 = 0 ... T_N = 1.
  /// `binary`: the step function instead of the smooth one.
  CurvedLayers(std::span<const double> density, std::vector<double> time_points, double beta, bool binary);

  int count() const { return static_cast<int>(time_points_.size()) - 1; }
  double beta() const { return beta_; }
  /// Densities for a pseudo-time (part field). Local to the rank.
  LayerDensities densities(std::span<const double> time) const;
  /// The same in the memory of an earlier result.
  void set_densities(std::span<const double> time, LayerDensities& densities) const;
  /// Adds the derivative with respect to the pseudo-time to `d_time` (part field) and, unless that is empty, what
  /// this rank's elements contribute to the one with respect to T_0 ... T_N to `d_time_points`. Zero for binary
  /// layers. Derivatives by the time points themselves stay with their owner.
  void pull_back(std::span<const double> time, const DensityDerivatives& derivatives,
                 std::span<double> d_time, std::span<double> d_time_points = {}) const;

 private:
  /// Takes from `stage` what is built after a time point.
  void apply_step(std::span<const double> time, double time_point, std::span<double> stage) const;

  std::span<const double> density_;
  std::vector<double> time_points_;
  double beta_;
  bool binary_;
};

/// Index of the layer (1 to N) that builds each element, by its pseudo-time: the first whose time point is not
/// earlier. `time_points`: T_0 ... T_N.
std::vector<double> layer_index(std::span<const double> time, std::span<const double> time_points);

}  // namespace fabseq
