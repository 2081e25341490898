// SPDX-License-Identifier: MIT
/// \file
/// Changes of a config that is simulated once more, otherwise than it was.
#pragma once

#include "fabseq/config/setup.h"

namespace fabseq {

/// The config of a setup to be changed: what "auto" stands for is fixed, so that a change of one thing
/// changes nothing else, and there are no constraints. Sharpness is no matter of it: its relations to the
/// number of layers shall refuse nothing.
template <int Dim>
Config config_to_change(const Setup<Dim>& setup);

/// Divides each element into factor^Dim.
void refine(Config& config, int factor);

/// Cuts the layers of a config_to_change(), and those of its baseline, into the real ones that they stand
/// for.
void cut_into_real_layers(Config& config);

}  // namespace fabseq
