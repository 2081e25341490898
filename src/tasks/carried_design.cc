// SPDX-License-Identifier: MIT
#include "tasks/carried_design.h"

#include "fabseq/grid/carried_field.h"

#include <vector>

namespace fabseq {

template <int Dim>
Design carried_design(const Setup<Dim>& from, const Design& design, const Setup<Dim>& to, int factor) {
  const DesignSupport<Dim>& support = from.design_support;
  const auto owned = [&](const Setup<Dim>& setup) {
    return support.on_nodes() ? setup.grid.owned_nodes() : setup.grid.owned_elements();
  };
  const std::vector<double> field = from.design_field(design.field);
  // Other layer groups have copies.
  const IndexBox<Dim> own = from.groups.index() == 0 ? owned(from) : IndexBox<Dim>{};
  const std::vector<double> carried =
      carried_field<Dim>(to.world(), own, field, support.components(), owned(to), factor);
  return {to.groups.share(to.design_support.restrict_to_variables(carried)), design.layer_variables};
}

FABSEQ_INSTANTIATE_FUNCTION(carried_design);

}  // namespace fabseq
