// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/field_set.h"
#include "fabseq/optimize/problem.h"
#include "fabseq/process/built_strain.h"
#include "fabseq/report/build_report.h"
#include "fabseq/report/finished_shape.h"
#include "fabseq/report/real_layers.h"
#include "fabseq/report/verdict.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// A layer's volume, thickness and its coefficient of variation.
struct LayerNumbers {
  double volume = 0.0, thickness = 0.0, variation = 0.0;
  int sub_part = 0, slab = 0;  ///< of multi-planar layers, sub-parts from 1; 0: layers without sub-parts
  std::optional<double> interpass = std::nullopt;  ///< temperature at which it begins, degrees Celsius
};

/// What a deposition model (docs/formulation.md 4.6) makes of a sequence, before the release.
struct DepositionNumbers : DisplacementSizes {
  std::vector<NamedValue> distortions;  ///< values of the objective's terms of that type
};
struct BothDepositions {
  DepositionNumbers own;                   ///< the model that the sequence was made for
  std::optional<DepositionNumbers> other;  ///< not known if only what is built was simulated
  DepositionModel own_model = DepositionModel::nominal;
};

/// What the scenarios of the strain make of a term of the objective, J each (docs/formulation.md 5.1).
struct ScenarioNumbers {
  std::string name;            ///< of the term
  std::vector<double> values;  ///< of each scenario
  double mean = 0.0, spread = 0.0, worst = 0.0;
};

/// What is reported of one evaluated sequence, be it optimized, binary, planar or the start. The same on all
/// ranks.
struct SequenceNumbers {
  std::vector<NamedValue> responses;
  std::vector<LayerNumbers> layers;
  BothDepositions depositions;
  std::vector<ScenarioNumbers> scenarios;  ///< of each distortion term; empty without scenarios
  std::optional<FinishedShape> finished;   ///< where it was asked for
  Found found;                             ///< checks and places only where the shape was asked for
  std::optional<Verdict> verdict;          ///< where the shape was asked for
  std::optional<RealLayers> real_layers;   ///< which checks and verdict are of; none: of the simulated ones

  /// First objective term.
  double first_objective() const { return responses.empty() ? 0.0 : responses[0].value; }
  /// Whether its root is a length.
  bool first_is_distortion() const { return !responses.empty() && responses[0].type == "distortion"; }
  /// Number of layers that hold more than a trace of the part's volume.
  int used_layers() const;
};

/// Numbers and fields of a sequence, copied out of the pipeline.
struct SequenceReport : SequenceNumbers {
  std::vector<std::vector<double>> values;  ///< of each response
  std::vector<double> time, layer;          ///< part fields
  std::vector<double> time_gradient;        ///< [part element][axis]; empty: only differences are known
  std::vector<double> temperature;          ///< on the owned nodes, or empty
  std::vector<double> nodal_time;           ///< PseudoTime::nodal
  std::vector<int> nodes;                   ///< ElasticModel::nodes: no others move
  std::vector<double> displacement;         ///< [nodes][component]
  BuildFields build_fields;                 ///< of the findings
  BuiltStrain strain;                       ///< where it was asked for
};

/// Adds time, layer, displacements and, where there are any, the other fields to a set, names prefixed. Part
/// and report must outlive it.
template <int Dim>
void add_sequence_fields(FieldSet<Dim>& fields, const Part<Dim>& part, const SequenceReport& report,
                         const std::string& prefix);
/// Adds the displacement and, where there is a release, what it adds and the sum of both.
template <int Dim>
void add_displacements(FieldSet<Dim>& fields, const SequenceReport& report, const std::string& prefix);

/// Reports the state of a pipeline's last run. `with_shape`: with the finished part, which takes a solve for
/// the release. Collective.
template <int Dim>
SequenceReport report_sequence(const Model<Dim>& model, const Problem<Dim>& problem, Pipeline<Dim>& pipeline,
                               const StageResults<Dim>& state, bool with_shape = true);

/// What elements took up in a pipeline's last run. Not collective.
template <int Dim>
BuiltStrain strain_when_built(const Pipeline<Dim>& pipeline) {
  return strain_when_built(pipeline.process().strains(), pipeline.last_layer_index());
}

/// What both deposition models make of a pipeline's last run. Collective.
template <int Dim>
BothDepositions report_depositions(const Model<Dim>& model, const Problem<Dim>& problem,
                                   Pipeline<Dim>& pipeline, const StageResults<Dim>& state);

}  // namespace fabseq
