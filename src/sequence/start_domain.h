// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/part/part.h"

namespace fabseq {

/// The domain of the scalar problems that pseudo-times come from: all elements of the box, the void included,
/// with prescribed values where a process begins, at the nodes of the part on the plate and at all nodes of
/// the substrate (docs/formulation.md 2.1, 2.4). Not collective.
template <int Dim>
SystemDomain start_domain(const Part<Dim>& part);

}  // namespace fabseq
