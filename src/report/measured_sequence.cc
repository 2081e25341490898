// SPDX-License-Identifier: MIT
#include "fabseq/report/measured_sequence.h"

#include "fabseq/machine/build_direction.h"
#include "fabseq/machine/torch.h"

namespace fabseq {

template <int Dim>
void MeasuredSequence<Dim>::find_direction() {
  gradient = time_gradient(model.part, time, layers);
  direction = build_direction<Dim>(gradient.values, layers, layer_index);
  axis = torch_axis<Dim>(model.part, model.settings.tool, direction);
}

FABSEQ_INSTANTIATE_STRUCT(MeasuredSequence);

}  // namespace fabseq
