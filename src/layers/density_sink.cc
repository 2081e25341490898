// SPDX-License-Identifier: MIT
#include "fabseq/layers/density_sink.h"

#include <utility>

namespace fabseq {

void DensitySink::pull_back(const DensityDerivatives& derivatives) {
  layers_.pull_back(time_, densities_, derivatives, DensityDerivatives::zeros_if_empty(d_time_, time_.size()),
                    d_variables_);
}

void DensitySink::flush() {
  DensityDerivatives taken(densities_.count());
  taken.stage.swap(from_.stage);
  taken.layer.swap(from_.layer);
  pull_back(taken);
}

void DensitySink::flush_all() { pull_back(std::exchange(from_, DensityDerivatives(densities_.count()))); }

}  // namespace fabseq
