// SPDX-License-Identifier: MIT
/// \file
/// What goes forward through the stages of the pipeline.
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/process/process_result.h"
#include "fabseq/process/strain_source.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/thermal/layer_temperatures.h"

namespace fabseq {

/// A result of a stage, which the stage owns; none where no stage has made it.
template <class Result>
class StageResult {
 public:
  StageResult() = default;
  StageResult(const Result& result) : result_(&result) {}  // NOLINT(google-explicit-constructor): a reference

  explicit operator bool() const { return result_ != nullptr; }
  const Result& operator*() const { return *result_; }
  const Result* operator->() const { return result_; }

 private:
  const Result* result_ = nullptr;
};

/// The results of the stages for one design. A stage's traits say by pointers to these members what it reads
/// and makes.
template <int Dim>
struct StageResults {
  StageResult<PseudoTime<Dim>> time = {};
  StageResult<LayerDensities> densities = {};
  StageResult<ProcessResult> process = {};
  StageResult<LayerTemperatures> temperatures = {};  ///< none: the strain does not follow the temperature
  StageResult<Layers> layers = {};
  StageResult<StrainSource<Dim>> strains = {};
};

}  // namespace fabseq
