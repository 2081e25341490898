// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/kernels/lane_vector.h"
#include "fabseq/process/elastic_model.h"
#include "process/element_modes.h"

#include <span>
#include <vector>

namespace fabseq {

/// Displacements at nodes to the strains and amplitudes of the model's elements (ElementModes), and forces of
/// these back to the nodes, several systems at once. Nodal values are on all owned nodes. Collective on the
/// grid's communicator.
class PlasticFields {
 public:
  /// The model must outlive the object.
  explicit PlasticFields(const ElasticModel<3>& model);

  /// Sets `modes`, [element][ElementModes][lane].
  void set_modes(const LaneVector& displacement, std::vector<double>& modes) const;
  /// Sets `force` to the sum of the elements' forces. `lanes`: those of `modes`.
  void set_forces(std::span<const double> modes, int lanes, LaneVector& force) const;
  const ElementModes& modes() const { return modes_; }

 private:
  const ElasticModel<3>& model_;
  ElementModes modes_;
};

}  // namespace fabseq
