// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"
#include "fabseq/solve/solve_tolerance.h"

#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace fabseq {

/// The pseudo-time on the part elements, and what it came from.
template <int Dim>
struct PseudoTime {
  std::vector<double> time;         ///< t_e, a part field, from 0 to 1
  std::vector<double> gradient;     ///< grad t at centres, [part element][axis], 1/length; empty: not defined
  std::vector<double> temperature;  ///< T on the owned nodes; empty if there is none
  std::vector<double> nodal;  ///< t on the owned nodes, where that is what the sequence varies; or empty
  double lowest_temperature = std::numeric_limits<double>::quiet_NaN();
  double highest_temperature = std::numeric_limits<double>::quiet_NaN();
  std::optional<int> iterations = std::nullopt;  ///< of the forward solve; none: nothing is solved for it
  /// grad t that was recorded beside times from a file, as `gradient`, for the checks of docs/formulation.md
  /// 13.1 alone; empty: none.
  std::vector<double> recorded_gradient = {};
};

/// Regularization eps^2, which is added to |grad t|^2 wherever the direction of grad t or the root is needed:
/// 1e-9 / l_c^2, 1/length^2 (docs/formulation.md 4.2, 6).
inline double gradient_regularization(double characteristic_length) {
  return 1e-9 / (characteristic_length * characteristic_length);
}

/// Derivative of a response with respect to the pseudo-time and its gradient, shaped as in PseudoTime. An
/// empty gradient stands for zero.
struct TimeDerivatives {
  std::vector<double> time, gradient;
};

/// The optimizer's view of a design variable: bounds of the physical variable, and the scale on which it
/// moves. The defaults are those of a pseudo-time.
struct DesignScale {
  double lower = 0.0, upper = 1.0;
  bool logarithmic = false;

  /// Position of a design value between the bounds, in [0, 1], and the design value at a position. Both are
  /// clipped to the bounds.
  double to_unit(double design) const;
  double from_unit(double unit) const;
  /// Derivative of the design value with respect to its position in [0, 1].
  double slope(double design) const;
};

/// The scales of all variables: each place of a DesignSupport has the same components, one after the other.
struct DesignSpace {
  std::vector<DesignScale> components = {{}};  ///< at least one

  int count() const { return static_cast<int>(components.size()); }
  /// The scale of an entry of a design, [place][component].
  const DesignScale& of(std::size_t entry) const { return components[entry % components.size()]; }
  /// Returns the space of vectors that begin with entry number `first` of a design, as a share of one does.
  DesignSpace from(std::size_t first) const;
};

/// Turns design variables into pseudo-time: the first stage of the pipeline (docs/formulation.md 2, 3.3).
/// update(), pull_back(), initial_design(), set_tolerance() and start_cold() are collective on the grid's
/// communicator, the other calls are not.
template <int Dim>
class Sequence {
 public:
  virtual ~Sequence() = default;

  /// Whether there is anything to optimize; the same on all ranks.
  virtual bool has_design() const { return false; }
  /// Number of design variables on this rank: those of its DesignSupport, [place][component], or 0 without a
  /// design.
  virtual std::size_t variables() const { return 0; }
  /// Bounds and scale of the variables; the same on all ranks.
  virtual DesignSpace space() const { return {}; }
  /// The design to start from, one entry per variable of this rank.
  virtual std::vector<double> initial_design() const { return {}; }
  /// Pseudo-time of a design. The reference stays valid until the next call. All layer groups must call it.
  virtual const PseudoTime<Dim>& update(std::span<const double> design) = 0;
  /// Gradients with respect to the design of the last update, one per row; each has one entry per variable of
  /// this rank.
  virtual std::vector<std::vector<double>> pull_back(std::span<const TimeDerivatives> rows) {
    return std::vector<std::vector<double>>(rows.size());
  }
  /// Later solves go to this tolerance.
  virtual void set_tolerance(const SolveTolerance& /*tolerance*/) {}
  /// Forgets what earlier solves left for later ones (HeatSolver::start_cold()).
  virtual void start_cold() {}
  /// Gives back memory that solves can take again (HeatSolver::release_memory()).
  virtual void release_memory() {}
  /// Solver iterations of the last pull_back(), one entry per row; empty without solves.
  virtual std::vector<int> adjoint_iterations() const { return {}; }
};

}  // namespace fabseq
