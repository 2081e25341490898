// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layers.h"

#include <span>
#include <vector>

namespace fabseq {

/// Where the derivatives of one functional with respect to the densities go: to the layers, which turn them
/// into those with respect to the pseudo-time and to their own variables. Whoever adds derivatives with
/// respect to the densities of some layers flushes them at once: those of all layers would fill the memory
/// for functionals by the dozen. Refers to all that it is made of.
class DensitySink {
 public:
  /// \param layers     those of the pseudo-time `time`, whose densities are `densities`
  /// \param from       what is handed on; its entries are taken out
  /// \param d_time     part field, sized at first use
  /// \param d_variables  this rank's part
  DensitySink(const Layers& layers, std::span<const double> time, const LayerDensities& densities,
              DensityDerivatives& from, std::vector<double>& d_time, std::vector<double>& d_variables)
      : layers_(layers),
        time_(time),
        densities_(densities),
        from_(from),
        d_time_(d_time),
        d_variables_(d_variables) {}

  /// Gives the layers the derivatives with respect to densities of stages and layers that have been added.
  /// Collective on the grid's communicator.
  void flush();
  /// Gives them the rest, too: those with respect to time points, sub-parts and directions. Collective
  /// likewise.
  void flush_all();

 private:
  void pull_back(const DensityDerivatives& derivatives);

  const Layers& layers_;
  std::span<const double> time_;
  const LayerDensities& densities_;
  DensityDerivatives& from_;
  std::vector<double>& d_time_;
  std::vector<double>& d_variables_;
};

}  // namespace fabseq
