// SPDX-License-Identifier: MIT
/// \file
/// PETSc with C++ manners: error codes become exceptions, and objects free themselves.
#pragma once

#include <petscdmda.h>
#include <petscksp.h>

#include <utility>

namespace fabseq {

/// Throws NumericalError with PETSc's own message if `code` is not 0. Wrap every PETSc call in it. Not
/// collective.
void check(PetscErrorCode code);
/// The same for calls that read the user's options: throws InputError.
void check_options(PetscErrorCode code);

/// Sole owner of a PETSc object; the destructor destroys it. Destruction is collective on the object's
/// communicator, as PETSc's own Destroy is, so handles must be destroyed in the same order on all ranks. The
/// handle converts to the raw object for PETSc calls.
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
  /// Address to hand to one of PETSc's Create functions. Frees what the handle held before.
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

/// Lends an array to `vector` for the lifetime of this object. The vector must have been made without an
/// array of its own. `values` must hold the vector's local size and outlive this object. A vector that is
/// only read may be lent a const array.
class PlacedArray {
 public:
  PlacedArray(Vec vector, const double* values) : vector_(vector) { check(VecPlaceArray(vector, values)); }
  ~PlacedArray() { (void)VecResetArray(vector_); }
  PlacedArray(PlacedArray&&) = delete;

 private:
  Vec vector_;
};

}  // namespace fabseq
