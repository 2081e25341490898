// SPDX-License-Identifier: MIT
#include "fabseq/base/petsc.h"

#include "fabseq/base/error.h"

#include <string>

namespace fabseq {

void check(PetscErrorCode code) {
  if (code == 0) return;
  const char* text = nullptr;
  char* specific = nullptr;
  (void)PetscErrorMessage(code, &text, &specific);
  std::string message = std::string("PETSc: ") + (text != nullptr ? text : "unknown error");
  if (specific != nullptr && specific[0] != '\0') message += std::string(": ") + specific;
  for (char& c : message)
    if (c == '\n') c = ' ';
  throw NumericalError(message);
}

}  // namespace fabseq
