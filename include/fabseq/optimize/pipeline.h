// SPDX-License-Identifier: MIT
/// \file
/// Design to responses and back: sequence, layers, process and responses in one chain (docs/architecture.md).
#pragma once

#include "fabseq/base/phase_timer.h"
#include "fabseq/files/checkpoint_state.h"
#include "fabseq/optimize/design.h"
#include "fabseq/optimize/model.h"
#include "fabseq/process/inherent_strain.h"
#include "fabseq/process/process_simulation.h"
#include "fabseq/responses/response.h"
#include "fabseq/sequence/sequence.h"

#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// Borrowed.
template <int Dim>
using Responses = std::span<const std::unique_ptr<Response<Dim>>>;

/// A component of a response with a factor; a gradient row is a sum of these.
struct WeightedComponent {
  int response = 0;
  int component = 0;
  double weight = 1.0;
};
using GradientRow = std::vector<WeightedComponent>;

/// Solver iterations of the last run and of the last gradients.
struct SolverIterations {
  std::vector<int> primal, adjoint, heat;
};

/// The chain of stages for one part. All calls are collective on the world of the model's layer groups. The
/// fields of a design and of its gradients are this rank's share of them (LayerGroups::share), all other
/// fields are on all copies.
///
/// Groups share the layers (ProcessSimulation) and, in gradients(), the rows: a row's heat adjoint and what
/// is explicit in it belong to one group. Rows that use displacements get a part of their derivative from
/// every group.
template <int Dim>
class Pipeline {
 public:
  /// \param sequence  where the pseudo-time comes from
  /// \param layers    which kind of layers it is cut into
  /// \param tolerance of the elastic solves; heat is solved a thousand times closer
  /// The models and the timer must outlive the pipeline.
  Pipeline(const Model<Dim>& model, std::unique_ptr<Sequence<Dim>> sequence, const LayerModel<Dim>& layers,
           double tolerance, PhaseTimer& timer);
  /// Takes sequence and layers that the model asks for.
  Pipeline(const Model<Dim>& model, double tolerance, PhaseTimer& timer);

  Sequence<Dim>& sequence() { return *sequence_; }
  const ProcessSimulation<Dim>& process() const { return process_; }
  ProcessSimulation<Dim>& process() { return process_; }

  /// Evaluates the stages for a design; `beta` and `binary` are those of LayerModel::make(). The state refers
  /// to results that stay valid until the next run.
  PipelineState<Dim> run(const Design& design, double beta, bool binary);
  /// Pseudo-time of the last run, also of one whose process simulation failed; nullptr if it did not get
  /// there.
  const PseudoTime<Dim>* last_time() const { return time_; }
  /// Number of the layer of each part element in the last run that has a pseudo-time (Layers::layer_index()).
  std::vector<double> last_layer_index() const { return layers_->layer_index(time_->time, densities_); }
  /// Values of all components of each of `responses`.
  std::vector<std::vector<double>> values(Responses<Dim> responses, const PipelineState<Dim>& state);
  /// Gradients of several rows with respect to the design of the last run.
  std::vector<Design> gradients(Responses<Dim> responses, const PipelineState<Dim>& state,
                                const std::vector<GradientRow>& rows);
  /// Gives back the memory of the solvers and of the last run's layers, which gradients and reports need. Not
  /// collective.
  void give_back_memory();
  /// Later runs and gradients are solved to these tolerances; the constructor's is all of them. Which layers
  /// are negligible stays as it was: that is part of the model.
  void set_tolerances(const Tolerances& tolerances) { tolerances_ = tolerances; }
  const Tolerances& tolerances() const { return tolerances_; }
  /// Forgets what earlier runs have left for later ones, warm solvers and the like, so that what comes next
  /// does not depend on them: the run after a checkpoint gives the same bits, restarted or not.
  void start_cold();
  /// Adds what start_cold() leaves: by what work the layers are dealt out to the groups next. Not collective.
  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);
  const SolverIterations& iterations() const { return iterations_; }

 private:
  /// A row on its way back through the stages.
  struct Row {
    const GradientRow* terms = nullptr;
    int owner = 0;        ///< group whose row it is
    bool shared = false;  ///< uses displacements: other groups have parts of it
    PipelineAdjoint<Dim> adjoint;
    std::vector<double> layer_variables;  ///< derivative by these, this rank's part
    StrainField strains;                  ///< dJ/d(inherent strain) where that turns, this group's part
  };
  std::vector<Row> deal_out_rows(Responses<Dim> responses, const PipelineState<Dim>& state,
                                 const std::vector<GradientRow>& rows) const;
  void pull_back_process(Responses<Dim> responses, const PipelineState<Dim>& state, std::vector<Row>& rows);
  void add_explicit_derivatives(Responses<Dim> responses, const PipelineState<Dim>& state, Row& row);
  void take_up_densities(const PipelineState<Dim>& state, Row& row) const;
  void pull_back_shared(const PipelineState<Dim>& state, std::vector<Row>& rows);
  void pull_back_layers(const PipelineState<Dim>& state, Row& row) const;
  std::vector<std::vector<double>> pull_back_own(Responses<Dim> responses, const PipelineState<Dim>& state,
                                                 std::vector<Row>& rows);
  std::vector<std::vector<double>> sum_up_layer_variables(const std::vector<Row>& rows) const;
  void solve_to(const SolveTolerance& of_sequence, const SolveTolerance& of_process);
  bool is_own(const Row& row) const { return row.owner == model_.groups.index(); }

  const Model<Dim>& model_;
  PhaseTimer& timer_;
  std::unique_ptr<Sequence<Dim>> sequence_;
  const LayerModel<Dim>& layer_model_;
  Tolerances tolerances_;
  NegligibleLayers negligible_;
  InherentStrain<Dim> strain_;
  ElasticModel<Dim> elastic_;
  ProcessSimulation<Dim> process_;
  std::unique_ptr<Layers> layers_;
  LayerDensities densities_;
  const PseudoTime<Dim>* time_ = nullptr;
  std::size_t layer_variables_ = 0;  ///< of the last run's design
  SolverIterations iterations_;
};

}  // namespace fabseq
