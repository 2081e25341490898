// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/chain/design.h"
#include "fabseq/config/setup.h"

namespace fabseq {

/// A design of one setup as that of another, which has the same box, the same kind of design and `factor`
/// times as many elements along each axis: each place of variables takes those of the one that it lies in, or
/// 0 where that has none. Collective on the world of both.
template <int Dim>
Design carried_design(const Setup<Dim>& from, const Design& design, const Setup<Dim>& to, int factor);

}  // namespace fabseq
