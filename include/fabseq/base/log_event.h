// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/petsc.h"

namespace fabseq {

/// A kind of work that -log_view reports by name, on one line within the stage of its phase. Make one at
/// first use, as a static variable of the function that does the work.
class LogEvent {
 public:
  /// Registers the event; PETSc must be initialized.
  explicit LogEvent(const char* name) {
    check(PetscLogEventGetId(name, &event_));
    if (event_ < 0) check(PetscLogEventRegister(name, KSP_CLASSID, &event_));
  }

  /// What happens between construction and destruction counts for the event.
  class Scope {
   public:
    explicit Scope(PetscLogEvent event) : event_(event) {
      check(PetscLogEventBegin(event_, nullptr, nullptr, nullptr, nullptr));
    }
    ~Scope() { (void)PetscLogEventEnd(event_, nullptr, nullptr, nullptr, nullptr); }
    Scope(Scope&&) = delete;

   private:
    PetscLogEvent event_;
  };
  [[nodiscard]] Scope enter() const { return Scope(event_); }

 private:
  PetscLogEvent event_ = -1;
};

}  // namespace fabseq
