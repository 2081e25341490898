// SPDX-License-Identifier: MIT
/// \file
/// What is reported of one evaluated sequence, be it optimized, binary or planar.
#pragma once

#include "fabseq/files/field_set.h"
#include "fabseq/optimize/problem.h"

#include <string>
#include <vector>

namespace fabseq {

/// Numbers and fields of a sequence, copied out of the pipeline.
template <int Dim>
struct SequenceReport {
  std::vector<std::vector<double>> values;  ///< of each response
  Json block;                               ///< responses, layers, displacement: the blocks of summary.json
  std::vector<double> time, layer;          ///< on the owned elements, 0 outside the part
  std::vector<double> temperature, displacement;  ///< on the owned nodes; temperature may be empty

  /// Adds time, layer, displacement and, if there is one, temperature to a set, names prefixed. The report
  /// must outlive it.
  void add_fields(FieldSet<Dim>& fields, const std::string& prefix) const;
  /// First objective term.
  double first_objective() const { return values.empty() ? 0.0 : values[0][0]; }
};

/// Reports the state of a pipeline's last run. Collective.
template <int Dim>
SequenceReport<Dim> report_sequence(const Model<Dim>& model, const Problem<Dim>& problem,
                                    Pipeline<Dim>& pipeline, const PipelineState<Dim>& state);

/// Largest and rms displacement ([owned node][component]) of the part's nodes: `max`, `rms`. Collective.
template <int Dim>
Json displacement_size(const Part<Dim>& part, const std::vector<double>& displacement);

/// Number of layers that hold more than a trace of the part's volume.
int used_layers(const Json& block);

extern template struct SequenceReport<2>;
extern template struct SequenceReport<3>;

}  // namespace fabseq
