// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"
#include "fabseq/process/build_step.h"
#include "fabseq/process/elastic_model.h"

#include <cstddef>

namespace fabseq {

/// Load factors of the part's elements in a step (BuildStep), with their derivatives with respect to the
/// density that they depend on: the layer's where it is added, else the stage density. Refers to model and
/// densities. Local.
template <int Dim>
class LoadFactors {
 public:
  LoadFactors(const ElasticModel<Dim>& model, const LayerDensities& densities, const BuildStep& step)
      : model_(model),
        adds_(step.adds),
        density_((step.adds ? densities.layer : densities.stage)[step.layer].data()) {}

  double operator()(std::size_t element) const {
    return adds_ ? model_.load(density_[element]) : model_.stiffness(density_[element]);
  }
  double derivative(std::size_t element) const {
    return adds_ ? model_.load_derivative(density_[element]) : model_.stiffness_derivative(density_[element]);
  }

 private:
  const ElasticModel<Dim>& model_;
  bool adds_;
  const double* density_;
};

}  // namespace fabseq
