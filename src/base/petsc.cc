// SPDX-License-Identifier: MIT
#include "fabseq/base/petsc.h"

#include "fabseq/base/error.h"

#include <string>

namespace fabseq {

namespace {

std::string message_of(PetscErrorCode code) {
  const char* text = nullptr;
  char* specific = nullptr;
  (void)PetscErrorMessage(code, &text, &specific);
  const bool is_specific = specific != nullptr && specific[0] != '\0';
  std::string message = "PETSc: ";
  if (text != nullptr || !is_specific) message += text != nullptr ? text : "unknown error";
  if (is_specific) message += (text != nullptr ? ": " : "") + std::string(specific);
  for (char& c : message)
    if (c == '\n') c = ' ';
  return message;
}

}  // namespace

void check(PetscErrorCode code) {
  if (code != 0) throw NumericalError(message_of(code));
}

void check_options(PetscErrorCode code) {
  if (code != 0) throw InputError(message_of(code) + "; allowed: options as PETSc's manual has them");
}

}  // namespace fabseq
