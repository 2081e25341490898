// SPDX-License-Identifier: MIT
#include "kernels/lane_transfer.h"

namespace fabseq {

template <int Dim>
LaneTransfer<Dim>::LaneTransfer(const LaneMesh<Dim>& fine, const LaneMesh<Dim>& coarse,
                                const Index<Dim>& factors)
    : halves_x_(factors[0] == 2) {
  for (const auto& nodes : fine.node_runs()) {
    Run run;
    run.fine = nodes.node;
    run.length = nodes.length;
    run.starts_between = nodes.index[0] % factors[0] != 0;
    Index<Dim> below{};
    int split_axes = 0;  // bit a: the nodes lie between two coarse lines along axis a + 1
    for (int axis = 0; axis < Dim; ++axis) {
      below[axis] = nodes.index[axis] / factors[axis];
      if (axis > 0 && nodes.index[axis] % factors[axis] != 0) split_axes |= 1 << (axis - 1);
    }
    run.lines = 0;
    for (int line = 0; line < max_lines; ++line) {
      if ((line & ~split_axes) != 0) continue;
      run.coarse[run.lines++] = coarse.node_number(stepped<Dim>(below, 2 * line, 1));
    }
    runs_.push_back(run);
  }
}

FABSEQ_INSTANTIATE_CLASS(LaneTransfer);

}  // namespace fabseq
