// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/chain/design.h"
#include "fabseq/config/setup.h"

#include <string>

namespace fabseq {

/// Writes a design alone, as -design reads it. Collective on the world; throws OutputError on all ranks.
template <int Dim>
void write_design(const Setup<Dim>& setup, const Design& design, const std::string& path);

}  // namespace fabseq
