// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// The pseudo-time on the part elements, and what it came from.
template <int Dim>
struct PseudoTime {
  std::vector<double> time;         ///< t_e, a part field, 0 to 1
  std::vector<double> gradient;     ///< grad t at centres, [part element][axis], 1/length; empty: not defined
  std::vector<double> temperature;  ///< T on the owned nodes; empty if there is none
  double lowest_temperature = std::numeric_limits<double>::quiet_NaN();
  double highest_temperature = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;  ///< of the forward solve
};

/// Regularization eps^2 of |grad t| wherever its direction or its root counts: 1e-9 / l_c^2
/// (docs/formulation.md 4.2, 6).
inline double gradient_regularization(double characteristic_length) {
  return 1e-9 / (characteristic_length * characteristic_length);
}

/// A response's derivative with respect to the pseudo-time and its gradient, shaped like PseudoTime.
struct TimeDerivatives {
  std::vector<double> time, gradient;
};

/// How the optimizer sees the design: bounds of the physical variable, and the scale on which it moves. By
/// default those of a time.
struct DesignSpace {
  double lower = 0.0, upper = 1.0;
  bool logarithmic = false;

  /// Position of a design value in [0, 1], and back.
  double to_unit(double design) const;
  double from_unit(double unit) const;
  /// d design / d unit at a design value.
  double slope(double design) const;
};

/// Design variables to pseudo-time: the first stage of the pipeline (docs/formulation.md 2, 3.3). All calls
/// are collective on the grid's communicator.
template <int Dim>
class Sequence {
 public:
  virtual ~Sequence() = default;

  /// Whether there is anything to optimize; the same on all ranks.
  virtual bool has_design() const { return false; }
  /// Number of design variables on this rank (of its DesignSupport, or none).
  virtual std::size_t variables() const { return 0; }
  virtual DesignSpace space() const { return {}; }
  /// The design to start from.
  virtual std::vector<double> initial_design() const { return {}; }
  /// Pseudo-time of a design; the reference stays valid until the next call. Where there are layer groups,
  /// all of them call it.
  virtual const PseudoTime<Dim>& update(std::span<const double> design) = 0;
  /// Gradients with respect to the design of the last update, one for each of several rows of derivatives.
  virtual std::vector<std::vector<double>> pull_back(std::span<const TimeDerivatives> rows) {
    return std::vector<std::vector<double>>(rows.size());
  }
  /// Forgets what earlier solves have left for later ones (HeatSolver::start_cold()).
  virtual void start_cold() {}
  /// Iterations of the last pull_back, a row each.
  virtual std::vector<int> adjoint_iterations() const { return {}; }
};

}  // namespace fabseq
