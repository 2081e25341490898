// SPDX-License-Identifier: MIT
/// \file
/// What a sequence asks of the machine, and what it leaves in the part.
#pragma once

#include "fabseq/machine/hanging.h"
#include "fabseq/machine/local_thickness.h"
#include "fabseq/optimize/pipeline.h"

#include <optional>
#include <vector>

namespace fabseq {

/// Residual stress of the part as built, on the plate.
struct StressNumbers {
  double von_mises = 0.0;                    ///< largest equivalent stress, stress unit
  std::optional<double> share_beyond_yield;  ///< of the part's volume; none without a yield stress
};

/// Figures of a sequence, the same on all ranks.
struct BuildNumbers {
  std::optional<ThicknessRange> local_thickness;  ///< none where it is not defined
  std::int64_t hanging = 0;                       ///< elements that begin in the air
  std::vector<std::int64_t> hanging_per_layer;
  std::vector<double> hanging_at;       ///< centre of one of the first of them; empty: none
  std::optional<double> wire, hours;    ///< kg; build time. None without density and deposition rate
  std::optional<StressNumbers> stress;  ///< where the config has a yield stress
};

/// The fields that these figures are taken from, on the owned elements, 0 outside the part. None where they
/// are not defined, on all ranks alike.
struct BuildFields {
  std::optional<std::vector<double>> direction;        ///< [element][axis]
  std::optional<std::vector<double>> local_thickness;  ///< length unit
  std::optional<std::vector<double>> hanging;          ///< 1 where an element begins in the air
};

struct BuildReport {
  BuildNumbers numbers;
  BuildFields fields;
};

/// Report of a pipeline's last run, of its binary layers whatever layers it ran with (docs/formulation.md
/// 13.1). `used_layers`: those with more than a trace of the volume. Collective.
template <int Dim>
BuildReport report_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const PipelineState<Dim>& state, int used_layers);

}  // namespace fabseq
