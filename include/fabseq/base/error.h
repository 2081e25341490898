// SPDX-License-Identifier: MIT
/// \file
/// Errors that end the program. Each has the exit status that users and job scripts rely on
/// (docs/reference.md).
#pragma once

#include <stdexcept>
#include <string>

namespace fabseq {

/// What `main` returns.
enum class ExitStatus { done = 0, bad_input = 2, numerical_failure = 3, stopped = 4, output_failure = 5 };

/// Base of all errors of fabseq. An error is thrown on every rank of the world with the same text. A failure
/// of a single rank goes through one of the calls of verdict.h first.
class Error : public std::runtime_error {
 public:
  Error(ExitStatus status, const std::string& message) : std::runtime_error(message), status_(status) {}
  ExitStatus status() const { return status_; }

 private:
  ExitStatus status_;
};

template <ExitStatus Status>
class ErrorWith : public Error {
 public:
  explicit ErrorWith(const std::string& message) : Error(Status, message) {}
};

/// The user's config, command line or files are wrong. Thrown before anything is written. `message` is one
/// line that names the key (JSON pointer), what was found and what is allowed.
using InputError = ErrorWith<ExitStatus::bad_input>;
/// A solver diverged or a NaN appeared.
using NumericalError = ErrorWith<ExitStatus::numerical_failure>;
/// The run was asked to end early (stop.h). This is no failure: what was reached is kept.
using Stopped = ErrorWith<ExitStatus::stopped>;
/// A file or directory could not be written.
using OutputError = ErrorWith<ExitStatus::output_failure>;

}  // namespace fabseq
