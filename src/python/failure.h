// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/error.h"
#include "fabseq/base/one_line.h"

#include <algorithm>
#include <array>
#include <exception>
#include <new>
#include <pybind11/pybind11.h>
#include <string>
#include <string_view>
#include <utility>

namespace fabseq {

/// What went wrong on a rank, as Python sees it: the name of a class of exceptions, and its text.
struct Failure {
  std::string type, message;
};

/// The failure of one rank, thrown on all of them.
class SharedFailure : public std::exception {
 public:
  explicit SharedFailure(Failure failure) : failure_(std::move(failure)) {}
  const char* what() const noexcept override { return failure_.message.c_str(); }
  const Failure& failure() const { return failure_; }

 private:
  Failure failure_;
};

/// Classes of exceptions that are made of a text.
constexpr std::array<std::string_view, 8> plain_exceptions = {"ValueError",    "TypeError",     "KeyError",
                                                              "OverflowError", "OSError",       "IndexError",
                                                              "MemoryError",   "AttributeError"};

/// ValueError for what the user can mend, RuntimeError for a solver that fails; others keep their class.
inline Failure failure_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const SharedFailure& shared) {
    return shared.failure();
  } catch (const InputError& refusal) {
    return {"ValueError", one_line(refusal.what())};
  } catch (const Error& failure) {
    return {"RuntimeError", one_line(failure.what())};
  } catch (const pybind11::error_already_set& raised) {
    const auto name = raised.type().attr("__name__").cast<std::string>();
    const auto text = one_line(pybind11::str(raised.value()).cast<std::string>());
    if (std::find(plain_exceptions.begin(), plain_exceptions.end(), name) != plain_exceptions.end())
      return {name, text};
    return {"RuntimeError", name == "RuntimeError" ? text : name + ": " + text};
  } catch (const pybind11::type_error& wrong) {
    return {"TypeError", wrong.what()};
  } catch (const std::bad_alloc&) {
    return {"MemoryError", "there is not enough memory"};
  } catch (const std::exception& other) {
    return {"RuntimeError", one_line(other.what())};
  }
}

inline void raise_in_python(const Failure& failure) {
  const pybind11::object type = pybind11::module_::import("builtins").attr(failure.type.c_str());
  PyErr_SetString(type.ptr(), failure.message.c_str());
}

}  // namespace fabseq
