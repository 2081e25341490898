// SPDX-License-Identifier: MIT
/// \file
/// Gradient rows on their way back through the stages, and which layer group has what of them.
#pragma once

#include "fabseq/base/phase_timer.h"
#include "fabseq/chain/design.h"
#include "fabseq/layers/density_sink.h"
#include "fabseq/model/model.h"
#include "fabseq/responses/response.h"
#include "fabseq/responses/stage_derivatives.h"
#include "fabseq/responses/stage_results.h"

#include <deque>
#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// Borrowed.
template <int Dim>
using Responses = std::span<const std::shared_ptr<const Response<Dim>>>;

/// A component of a response with a factor; a gradient row is a sum of these.
struct WeightedComponent {
  int response = 0;
  int component = 0;
  double weight = 1.0;
};
using GradientRow = std::vector<WeightedComponent>;

/// A row for every component of every response, in their order.
std::vector<GradientRow> all_components(const std::vector<std::vector<double>>& values);

/// A row on its way back.
template <int Dim>
struct AdjointRow {
  AdjointRow(const GradientRow& terms_, const Layers& layers, const StageResults<Dim>& state,
             std::size_t variables)
      : terms(terms_),
        adjoint(state.densities->count()),
        layer_variables(variables, 0.0),
        sink(layers, state.time->time, *state.densities, adjoint.densities, adjoint.time.time,
             layer_variables) {}
  AdjointRow(AdjointRow&&) = delete;  // the sink refers to its members

  const GradientRow& terms;
  int owner = 0;        ///< group whose row it is
  bool own = false;     ///< whether that is this group
  bool shared = false;  ///< uses displacements: every group has a part of it
  StageDerivatives<Dim> adjoint;
  std::vector<double> layer_variables;  ///< dJ/d(these), this rank's part
  DensitySink sink;                     ///< takes adjoint.densities
  std::vector<double> field;            ///< dJ/d(design's field), in the owner's group
  int iterations = 0;                   ///< of the sequence's adjoint, in the owner's group
};

template <int Dim>
using AdjointRowSpan = std::span<AdjointRow<Dim>* const>;

/// The rows of one gradient evaluation. Rows are dealt out to the groups: its owner group computes a row's
/// sequence adjoint and all explicit derivatives except those with respect to displacements. Collective on
/// the world of the model's groups unless a call says otherwise.
template <int Dim>
class AdjointRows {
 public:
  /// Local. All arguments must outlive the object. `variables`: number of the layers' variables.
  AdjointRows(const Model<Dim>& model, PhaseTimer& timer, Responses<Dim> responses,
              const StageResults<Dim>& state, const Layers& layers, const std::vector<GradientRow>& rows,
              std::size_t variables);

  /// Rows that use displacements, of which all groups have parts. Local.
  std::vector<AdjointRow<Dim>*> shared();
  /// This group's own rows. Local.
  std::vector<AdjointRow<Dim>*> own();
  /// Adds the responses' explicit derivatives with respect to each stage's results; those with respect to the
  /// densities are flushed at once. Collective on the grid's communicator.
  void add_explicit(AdjointRow<Dim>& row) const;
  /// Sums up the groups' parts of the shared rows' derivatives with respect to the pseudo-time, at the rows'
  /// owners.
  void sum_at_owners();
  /// Gradients with respect to this rank's share of `variables` design variables and to the layers'
  /// variables.
  std::vector<Design> gradients(std::size_t variables);
  /// Iterations of the sequence's adjoints, an entry per row.
  std::vector<int> iterations() const;

 private:
  std::vector<std::vector<double>> summed_layer_variables() const;

  const Model<Dim>& model_;
  PhaseTimer& timer_;
  Responses<Dim> responses_;
  const StageResults<Dim>& state_;
  std::deque<AdjointRow<Dim>> rows_;
};

}  // namespace fabseq
