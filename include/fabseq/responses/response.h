// SPDX-License-Identifier: MIT
/// \file
/// Measures of a fabrication sequence: one interface for objective terms and constraints.
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/machine/tool_settings.h"
#include "fabseq/part/node_set.h"
#include "fabseq/process/build_clock.h"
#include "fabseq/responses/stage_derivatives.h"
#include "fabseq/responses/stage_results.h"
#include "fabseq/responses/term.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/thermal/thermal_settings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// What all responses of a run may know of the part. References must outlive the responses.
template <int Dim>
struct ResponseContext {
  const Part<Dim>& part;
  const std::map<std::string, NodeSet>& node_sets;
  double characteristic_length;      ///< l_c of docs/formulation.md 6
  std::span<const char> start = {};  ///< part field: 1 in a direct sequence's start region; or empty
  int sub_parts = 0;                 ///< number of sub-parts of multi-planar layers, 0 for other layers
  ToolSettings tool = {};            ///< torch and bead
  double target_thickness = 0.0;     ///< of simulated layers, length unit; 0: none
  std::optional<ThermalSettings> thermal = std::nullopt;  ///< of layers whose strains follow the temperature
  std::optional<BuildClock> clock = std::nullopt;         ///< none: the time of the build is not known
  int passes = 1;                                         ///< real layers that a simulated one stands for
  /// Weight of each part element in smooth counts of a machine's limits (docs/formulation.md 13.2); null: all
  /// alike.
  const std::vector<double>* element_weights = nullptr;

  double weight_of(std::size_t element) const {
    return element_weights != nullptr ? (*element_weights)[element] : 1.0;
  }
};

/// An inequality for the optimizer: sign * (value of a component) <= sign * bound. Both sides are divided by
/// `scale`; or else the optimizer sees the logarithms of both, for components that range over orders of
/// magnitude (docs/formulation.md 13.2).
struct ConstraintRow {
  double sign = 1.0;         ///< 1: upper bound, -1: lower bound
  double bound = 0.0;        ///< in the unit of the component
  double scale = 1.0;        ///< in the unit of the component, > 0
  bool logarithmic = false;  ///< values and bound are positive; `scale` is not used
  bool adapts = false;       ///< `bound` is only where it starts: exact checks tell what does (13.2)

  /// Not positive if the inequality holds for a component with this value.
  double violation(double value) const {
    return logarithmic ? sign * std::log(std::max(value, least) / bound) : sign * (value - bound) / scale;
  }
  /// Derivative of violation() with respect to the value.
  double slope(double value) const { return sign / (logarithmic ? std::max(value, least) : scale); }

  static constexpr double least = 1e-100;  ///< whose logarithm is taken in place of that of 0
};

template <int Dim>
class Response;

/// Functionals whose squares add up to the value of an objective, less a rest >= 0
/// (docs/developer/optimizer.md 9.2).
template <int Dim>
struct SumOfSquares {
  std::unique_ptr<Response<Dim>> functionals;  ///< its components
  int count = 0;                               ///< number of components, at least one
  bool complete = false;                       ///< whether the rest is zero for all displacements
  bool asked_for = false;  ///< whether the user asks for them even if they hold little of the value
};

/// A functional of a sequence with one or several components. All calls are collective on the grid's
/// communicator unless they say otherwise, and values are the same on all ranks. Each layer group makes its
/// calls for itself; values() and add_derivative() of those that use displacements are called by all groups.
template <int Dim>
class Response {
 public:
  virtual ~Response() = default;

  /// Whether values depend on displacements, in which case its rows need the adjoints of all layers. Not
  /// collective.
  virtual bool uses_displacements() const { return false; }
  /// What values of an objective are compared with to tell rounding: those of a sequence without any order.
  /// 0: values that depend on displacements are squares of lengths, others have no rounding. Not collective.
  virtual double size() const { return 0.0; }
  /// Raw values, one per component.
  virtual std::vector<double> values(const StageResults<Dim>& state) const = 0;
  /// Adds weight * d(value of the component) to the derivatives with respect to each stage's results that the
  /// component depends on.
  virtual void add_derivative(int component, double weight, const StageResults<Dim>& state,
                              StageDerivatives<Dim>& adjoint) const = 0;
  /// The optimizer's rows for each component of a constraint. Allowed ranges are shrunk to `margin` times
  /// their width; margin 1 gives the user's constraint. Empty for responses that are objectives. Not
  /// collective.
  virtual std::vector<ConstraintRow> rows(double /*margin*/) const { return {}; }
  /// The sum of squares that the optimizer may be given in place of an objective with that scaling; none if
  /// the objective is no sum of squares or is not to be handed over as one. Collective.
  virtual std::optional<SumOfSquares<Dim>> squares(TermScaling /*scaling*/) const { return std::nullopt; }
  /// The response whose largest component is this one's value, if that is how it is defined: the optimizer is
  /// given all of them (docs/developer/optimizer.md 9.3); else nullptr. Collective.
  virtual std::unique_ptr<Response<Dim>> largest_of() const { return nullptr; }
};

/// Responses, which several owners may share.
template <int Dim>
using ResponseList = std::vector<std::shared_ptr<const Response<Dim>>>;

}  // namespace fabseq
