// SPDX-License-Identifier: MIT
/// \file
/// Design to responses and back: sequence, layers, process and responses in one chain (docs/architecture.md).
#pragma once

#include "fabseq/base/phase_timer.h"
#include "fabseq/chain/adjoint_rows.h"
#include "fabseq/chain/design.h"
#include "fabseq/chain/process_stage.h"
#include "fabseq/chain/sequence_stage.h"
#include "fabseq/chain/stage.h"
#include "fabseq/files/checkpoint_state.h"
#include "fabseq/model/model.h"
#include "fabseq/responses/response.h"

#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// The chain of stages for one part. All calls are collective on the world of the model's layer groups. The
/// fields of a design and of its gradients are this rank's share of them (LayerGroups::share), all other
/// fields are on all copies.
///
/// Groups share the layers (ElasticProcess) and, in gradients(), the rows: a row's heat adjoint and what
/// is explicit in it belong to one group. Rows that use displacements get a part of their derivative from
/// every group.
template <int Dim>
class Pipeline {
 public:
  /// \param sequence  where the pseudo-time comes from
  /// \param layers    which kind of layers it is cut into
  /// \param tolerance of the elastic solves; the sequence's heat equation is solved a thousand times closer
  /// The models and the timer must outlive the pipeline.
  Pipeline(const Model<Dim>& model, std::unique_ptr<Sequence<Dim>> sequence, const LayerModel<Dim>& layers,
           double tolerance, PhaseTimer& timer);
  /// Takes sequence and layers that the model asks for.
  Pipeline(const Model<Dim>& model, double tolerance, PhaseTimer& timer);

  Sequence<Dim>& sequence() { return sequence_->sequence(); }
  const Process<Dim>& process() const { return process_->process(); }
  Process<Dim>& process() { return process_->process(); }

  /// Evaluates the stages for a design; `beta` and `binary` are those of LayerModel::make(). The state refers
  /// to results that stay valid until the next run.
  StageResults<Dim> run(const Design& design, double beta, bool binary);
  /// Pseudo-time of the last run, also of one whose process simulation failed; nullptr if it did not get
  /// there.
  const PseudoTime<Dim>* last_time() const { return results_.time ? &*results_.time : nullptr; }
  /// Number of the layer of each part element in the last run that has a pseudo-time (Layers::layer_index()).
  std::vector<double> last_layer_index() const {
    return results_.layers->layer_index(results_.time->time, *results_.densities);
  }
  /// Values of all components of each of `responses`.
  std::vector<std::vector<double>> values(Responses<Dim> responses, const StageResults<Dim>& state);
  /// Gradients of several rows with respect to the design of the last run.
  std::vector<Design> gradients(Responses<Dim> responses, const StageResults<Dim>& state,
                                const std::vector<GradientRow>& rows);
  /// Gives back the memory of the solvers and of the last run's layers, which gradients and reports need. Not
  /// collective.
  void release_memory();
  /// Later runs and gradients are solved to these tolerances; the constructor's is all of them. Which layers
  /// are negligible stays as it was: that is part of the model.
  void set_tolerances(const Tolerances& tolerances) { tolerances_ = tolerances; }
  const Tolerances& tolerances() const { return tolerances_; }
  /// Elements of the elastic and thermal systems of later runs; at first all (whole).
  void set_region(SolverRegion region) { region_ = region; }
  SolverRegion region() const { return region_; }
  /// Forgets what earlier runs have left for later ones, warm solvers and the like, so that what comes next
  /// does not depend on them: the run after a checkpoint gives the same bits, restarted or not.
  void start_cold();
  /// Adds what start_cold() leaves: by what work the layers are dealt out to the groups next. Not collective.
  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);
  SolverIterations iterations() const;

 private:
  /// Takes rows back through the stages, last to first: those of the owner, or all others.
  void pull_back(const StageResults<Dim>& state, AdjointRowSpan<Dim> rows, bool of_owner);
  void pull_back_own(const StageResults<Dim>& state, AdjointRows<Dim>& adjoints);

  const Model<Dim>& model_;
  PhaseTimer& timer_;
  Tolerances tolerances_;
  SolverRegion region_ = SolverRegion::whole;
  std::vector<std::unique_ptr<Stage<Dim>>> stages_;  ///< each behind those whose results it reads
  SequenceStage<Dim>* sequence_ = nullptr;           ///< the first one
  ProcessStage<Dim>* process_ = nullptr;
  StageResults<Dim> results_;
  std::size_t layer_variables_ = 0;      ///< of the last run's design
  std::vector<int> adjoint_iterations_;  ///< of the sequence, in the last gradients
};

}  // namespace fabseq
