// SPDX-License-Identifier: MIT
/// \file
/// Lends an array to a PETSc vector for the length of a scope: scatters without copies.
#pragma once

#include "fabseq/base/petsc.h"

namespace fabseq {

/// While it lives, the values of `vector` (made without an array of its own) are those at `values`, which
/// must hold the vector's local size and outlive the scope. A vector that is only read from may be lent a
/// const array.
class PlacedArray {
 public:
  PlacedArray(Vec vector, const double* values) : vector_(vector) { check(VecPlaceArray(vector, values)); }
  ~PlacedArray() { (void)VecResetArray(vector_); }
  PlacedArray(const PlacedArray&) = delete;
  PlacedArray& operator=(const PlacedArray&) = delete;

 private:
  Vec vector_;
};

}  // namespace fabseq
