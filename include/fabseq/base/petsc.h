// SPDX-License-Identifier: MIT
/// \file
/// PETSc with C++ manners: error codes become exceptions, objects free themselves.
#pragma once

#include <petscdmda.h>
#include <petscksp.h>

#include <utility>

namespace fabseq {

/// Throws NumericalError with PETSc's own message where `code` is not 0. Wrap every PETSc call in it.
void check(PetscErrorCode code);

/// Sole owner of a PETSc object; destroyed with the handle (collective on the object's communicator, like
/// PETSc's own Destroy, so handles must die in the same order on all ranks). Converts to the raw object for
/// PETSc calls.
template <class Object, PetscErrorCode (*Destroy)(Object*)>
class PetscHandle {
 public:
  PetscHandle() = default;
  /// Takes ownership of `object`.
  explicit PetscHandle(Object object) : object_(object) {}
  PetscHandle(PetscHandle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  PetscHandle& operator=(PetscHandle&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~PetscHandle() { reset(); }

  operator Object() const { return object_; }
  explicit operator bool() const { return object_ != nullptr; }
  /// For PETSc's Create functions; frees what the handle held before.
  Object* receive() {
    reset();
    return &object_;
  }
  void reset() noexcept {
    if (object_ != nullptr) (void)Destroy(&object_);
    object_ = nullptr;
  }

 private:
  Object object_ = nullptr;
};

using VecHandle = PetscHandle<Vec, VecDestroy>;
using MatHandle = PetscHandle<Mat, MatDestroy>;
using KspHandle = PetscHandle<KSP, KSPDestroy>;
using DmHandle = PetscHandle<DM, DMDestroy>;
using IndexSetHandle = PetscHandle<IS, ISDestroy>;
using ScatterHandle = PetscHandle<VecScatter, VecScatterDestroy>;
using NullSpaceHandle = PetscHandle<MatNullSpace, MatNullSpaceDestroy>;

/// While it lives, the values of `vector` (made without an array of its own) are those at `values`, which
/// must hold the vector's local size and outlive the scope. A vector that is only read from may be lent a
/// const array.
class PlacedArray {
 public:
  PlacedArray(Vec vector, const double* values) : vector_(vector) { check(VecPlaceArray(vector, values)); }
  ~PlacedArray() { (void)VecResetArray(vector_); }
  PlacedArray(PlacedArray&&) = delete;

 private:
  Vec vector_;
};

}  // namespace fabseq
