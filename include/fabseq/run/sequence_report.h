// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/field_set.h"
#include "fabseq/optimize/problem.h"

#include <string>
#include <vector>

namespace fabseq {

/// A layer's volume, thickness and its coefficient of variation.
struct LayerNumbers {
  double volume = 0.0, thickness = 0.0, variation = 0.0;
  int sub_part = 0, slab = 0;  ///< of multi-planar layers, sub-parts from 1; 0: layers without sub-parts
};

/// Length of the displacement of the part's nodes.
struct DisplacementSize {
  double largest = 0.0, rms = 0.0;
};

/// What is reported of one evaluated sequence, be it optimized, binary or planar. The same on all ranks.
struct SequenceNumbers {
  std::vector<NamedValue> responses;
  std::vector<LayerNumbers> layers;
  DisplacementSize displacement_size;

  /// First objective term.
  double first_objective() const { return responses.empty() ? 0.0 : responses[0].value; }
  /// Number of layers that hold more than a trace of the part's volume.
  int used_layers() const;
};

/// Numbers and fields of a sequence, copied out of the pipeline.
template <int Dim>
struct SequenceReport : SequenceNumbers {
  std::vector<std::vector<double>> values;        ///< of each response
  std::vector<double> time, layer;                ///< on the owned elements, 0 outside the part
  std::vector<double> temperature, displacement;  ///< on the owned nodes; temperature may be empty

  /// Adds time, layer, displacement and, if there is one, temperature to a set, names prefixed. The report
  /// must outlive it.
  void add_fields(FieldSet<Dim>& fields, const std::string& prefix) const;
};

/// Reports the state of a pipeline's last run. Collective.
template <int Dim>
SequenceReport<Dim> report_sequence(const Model<Dim>& model, const Problem<Dim>& problem,
                                    Pipeline<Dim>& pipeline, const PipelineState<Dim>& state);

/// Size of a displacement, [owned node][component]. Collective.
template <int Dim>
DisplacementSize displacement_size(const Part<Dim>& part, const std::vector<double>& displacement);

}  // namespace fabseq
