// SPDX-License-Identifier: MIT
/// \file
/// Errors that end the program, each with the exit status users and job scripts rely on
/// (docs/reference.md).
#pragma once

#include <stdexcept>
#include <string>

namespace fabseq {

/// What `main` returns.
enum class ExitStatus { done = 0, bad_input = 2, numerical_failure = 3, stopped = 4, output_failure = 5 };

/// Base of all errors of fabseq. Thrown on every rank of the world with the same text: what a single rank
/// runs into goes through a verdict first (verdict.h).
class Error : public std::runtime_error {
 public:
  Error(ExitStatus status, const std::string& message) : std::runtime_error(message), status_(status) {}
  ExitStatus status() const { return status_; }

 private:
  ExitStatus status_;
};

/// The user's config, command line or files are wrong; thrown before anything is written. `message` is one
/// line that names the key (JSON pointer), what was found and what is allowed.
class InputError : public Error {
 public:
  explicit InputError(const std::string& message) : Error(ExitStatus::bad_input, message) {}
};

/// A solver diverged or a NaN appeared.
class NumericalError : public Error {
 public:
  explicit NumericalError(const std::string& message) : Error(ExitStatus::numerical_failure, message) {}
};

/// Somebody asked the run to end before its time (stop.h). Not a failure: what was reached is kept.
class Stopped : public Error {
 public:
  explicit Stopped(const std::string& message) : Error(ExitStatus::stopped, message) {}
};

/// A file or directory could not be written.
class OutputError : public Error {
 public:
  explicit OutputError(const std::string& message) : Error(ExitStatus::output_failure, message) {}
};

}  // namespace fabseq
