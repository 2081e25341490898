// SPDX-License-Identifier: MIT
/// \file
/// What is wrong with an input, as text.
#pragma once

#include "fabseq/base/error.h"

#include <string>

namespace fabseq::test {

/// The message of the InputError that `f` throws, "no error" if it throws none.
template <class Function>
std::string refusal(Function&& f) {
  try {
    f();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace fabseq::test
