// SPDX-License-Identifier: MIT
/// \file
/// What is measured on a fabrication sequence: one interface for objective terms and constraints.
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/part/node_set.h"
#include "fabseq/process/process_simulation.h"
#include "fabseq/responses/term.h"
#include "fabseq/sequence/sequence.h"

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// What all responses of a run may know of the part.
template <int Dim>
struct ResponseContext {
  const Part<Dim>& part;
  const std::map<std::string, NodeSet>& node_sets;
  double characteristic_length;  ///< l_c of docs/formulation.md 6
  std::span<const char> start =
      {};             ///< part field: 1 in the start region of a direct sequence; empty: there is none
  int sub_parts = 0;  ///< of multi-planar layers
};

/// The stages of the pipeline for one design. References to the pipeline's own results.
template <int Dim>
struct PipelineState {
  const PseudoTime<Dim>& time;
  const LayerDensities& layers;
  const ProcessResult& process;
};

/// Where responses leave their derivatives: one row of adjoints, with respect to each stage.
template <int Dim>
struct PipelineAdjoint {
  explicit PipelineAdjoint(int layers) : densities(layers) {}

  ProcessAdjoint process;        ///< dJ/du, dJ/dv and dJ/d(increments), empty while zero
  DensityDerivatives densities;  ///< explicit dependence on stage and layer densities and on time points
  TimeDerivatives time;          ///< explicit dependence on t and grad t, empty while zero
};

/// One inequality for the optimizer, sign * (value of a component) <= sign * bound, both in units of `scale`.
struct ConstraintRow {
  int component = 0;
  double sign = 1.0;
  double bound = 0.0;
  double scale = 1.0;

  /// <= 0 where the inequality holds.
  double violation(double value) const { return sign * (value - bound) / scale; }
};

template <int Dim>
class SumOfSquares;

/// A functional of a sequence with one or several components. Values are the same on all ranks; all calls are
/// collective on the grid's communicator unless they say otherwise; each layer group makes them for itself,
/// but values of what is said to use displacements are asked for by all groups.
template <int Dim>
class Response {
 public:
  virtual ~Response() = default;

  /// The config's name of the type. Not collective.
  virtual std::string type() const = 0;
  /// Whether it looks at displacements: its rows need the adjoints of all layers. Not collective.
  virtual bool uses_displacements() const { return false; }
  /// Raw values, one a component.
  virtual std::vector<double> values(const PipelineState<Dim>& state) const = 0;
  /// Adds weight * d(component) to the adjoint of each stage the component looks at.
  virtual void add_derivative(int component, double weight, const PipelineState<Dim>& state,
                              PipelineAdjoint<Dim>& adjoint) const = 0;
  /// As a constraint: the rows for the optimizer, allowed ranges shrunk to `margin` times their width; margin
  /// 1 is the user's constraint. Empty for responses that are objectives. Not collective.
  virtual std::vector<ConstraintRow> rows(int /*components*/, double /*margin*/) const { return {}; }
  /// As an objective with that scaling: what the optimizer may be given in its place. nullptr where it is no
  /// sum of squares, or shall not be handed over as one. Collective.
  virtual std::unique_ptr<SumOfSquares<Dim>> squares(TermScaling /*scaling*/) const { return nullptr; }
};

/// Components whose squares add up to the value of an objective less a rest >= 0 (docs/formulation.md 9).
template <int Dim>
class SumOfSquares : public Response<Dim> {
 public:
  /// Number of components.
  virtual int count() const = 0;
  /// Whether there is no rest, whatever the displacements.
  virtual bool complete() const = 0;
  /// Whether the user asks for them, even where they hold little of the value.
  virtual bool asked_for() const = 0;
};

}  // namespace fabseq
