// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/one_line.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/session.h"
#include "fabseq/config/command_line.h"
#include "python/agreement.h"
#include "python/evaluation.h"

#include <petscsys.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <span>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace fabseq {

namespace py = pybind11;

class PythonProblem;

/// MPI and PETSc, from the first problem until Python ends, and the problems that are open.
struct Runtime {
  std::unique_ptr<Session> session;
  std::unique_ptr<Agreement> agreement;
  std::vector<PythonProblem*> open;  ///< in the order in which they were made
  int made = 0;                      ///< problems, on all ranks
  pid_t process = 0;                 ///< that began the session
  bool ended = false;
};

inline Runtime& runtime() {
  static Runtime result;
  return result;
}

/// Whether MPI or PETSc have ended, or never begun.
inline bool mpi_has_ended() {
  int finalized = 0;
  MPI_Finalized(&finalized);
  PetscBool running = PETSC_FALSE;
  return finalized != 0 || PetscInitialized(&running) != 0 || running == PETSC_FALSE;
}

/// Destroys an object with parts of PETSc. After the end of MPI it is too late for that: the memory is left
/// to the end of the process.
template <class Object>
void let_go(std::unique_ptr<Object>& object) {
  if (mpi_has_ended()) (void)object.release();
  object.reset();
}

/// Begins MPI and PETSc, if that is still to be done.
inline void begin_runtime() {
  int finalized = 0;
  MPI_Finalized(&finalized);
  Runtime& now = runtime();
  if (now.ended || finalized != 0 || (now.session && mpi_has_ended()))
    throw std::runtime_error("MPI has ended");
  if (now.session) return;
  now.session = std::make_unique<Session>(std::vector<std::string>{"fabseq"});
  now.agreement = std::make_unique<Agreement>(PETSC_COMM_WORLD);
  now.process = ::getpid();
}

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Text of a Python object for messages, cut if it is long.
inline std::string shown_object(const py::handle& object) {
  constexpr std::size_t most = 60;
  const std::string text = one_line(py::repr(object).cast<std::string>());
  return text.size() <= most ? text : text.substr(0, most) + "...";
}

/// The numbers of a design or gradient that a program gives. `what`: its name in messages.
inline std::vector<double> numbers_of(const char* what, const py::object& given) {
  const auto as_it_is = py::array::ensure(given);
  const bool is_real = as_it_is && as_it_is.dtype().kind() != 'c';
  const Array array = is_real ? Array::ensure(as_it_is) : Array();
  if (!is_real || !array)
    throw py::type_error(std::string(what) + ": found " + shown_object(given) +
                         "; allowed: an array of numbers");
  if (array.ndim() != 1)
    throw InputError(std::string(what) + ": found an array with " + std::to_string(array.ndim()) +
                     " axes; allowed: 1");
  return {array.data(), array.data() + array.size()};
}

inline py::array array_of(const std::vector<double>& values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

/// A config as a program gives it, read as JSON: a path, or a document and the directory of its paths.
class GivenConfig {
 public:
  GivenConfig(const py::object& config, const py::object& set) {
    const py::object dumps = py::module_::import("json").attr("dumps");
    command_line_.task = Task::evaluate;
    if (!py::isinstance<py::dict>(set))
      throw py::type_error("set: found " + shown_object(set) + "; allowed: a dict of values by dotted paths");
    for (const auto& [path, value] : py::reinterpret_borrow<py::dict>(set))
      command_line_.overrides.emplace_back(py::str(path), dumps(value).cast<std::string>());
    if (py::isinstance<py::dict>(config))
      document_ = parse_json(dumps(config).cast<std::string>(), "config");
    else
      command_line_.config_file = py::module_::import("os").attr("fspath")(config).cast<std::string>();
  }

  /// What must be equal on all ranks.
  Json as_json() const {
    Json set = Json::object();
    for (const auto& [path, value] : command_line_.overrides) {
      const Json as_it_is = Json::parse(value, nullptr, /*allow_exceptions=*/false);
      set[path] = as_it_is.is_discarded() ? Json(one_line(value)) : as_it_is;
    }
    return Json::object(
        {{"config", document_ ? *document_ : Json(one_line(command_line_.config_file))}, {"set", set}});
  }

  /// Reads the config with the files and the order of members of rank 0. Collective on the ranks.
  Config read() const {
    if (!document_) return read_config(PETSC_COMM_WORLD, command_line_);
    const std::string text = broadcast(PETSC_COMM_WORLD, to_text(*document_));
    const std::string directory = broadcast(PETSC_COMM_WORLD, std::filesystem::current_path().string());
    return read_config(PETSC_COMM_WORLD, parse_json(text, "config"), directory, command_line_);
  }

 private:
  std::optional<Json> document_;
  CommandLine command_line_;
};

/// What Python sees as fabseq.Problem. Calls with an object are those of a program, which may give anything.
class PythonProblem {
 public:
  PythonProblem(const py::object& config, const py::object& set) {
    begin_runtime();
    std::optional<GivenConfig> given;
    runtime().agreement->run(
        [&] {
          given.emplace(config, set);
          return Call{"Problem()", 0, given->as_json()};
        },
        [&] { evaluation_ = make_evaluation(given->read()); });
    number_ = ++runtime().made;
    runtime().open.push_back(this);
  }
  PythonProblem(PythonProblem&&) = delete;
  ~PythonProblem() { close(); }

  void close() {
    std::erase(runtime().open, this);
    let_go(evaluation_);
  }
  /// Leaves the memory to the end of the process.
  void abandon() {
    std::erase(runtime().open, this);
    (void)evaluation_.release();
  }
  Evaluation& evaluation() const {
    if (!evaluation_) throw std::runtime_error("the problem is closed");
    if (mpi_has_ended()) throw std::runtime_error("MPI has ended");
    return *evaluation_;
  }
  int number() const { return number_; }

  int rank() const {
    (void)evaluation();
    return rank_of(PETSC_COMM_WORLD);
  }
  py::array design() const { return array_of(evaluation().start()); }
  py::tuple bounds() const {
    std::vector<double> lower, upper;
    for (const DesignScale& scale : evaluation().scales()) {
      lower.push_back(scale.lower);
      upper.push_back(scale.upper);
    }
    return py::make_tuple(array_of(lower), array_of(upper));
  }
  py::array logarithmic() const {
    const std::vector<DesignScale> scales = evaluation().scales();
    py::array_t<bool> result(static_cast<py::ssize_t>(scales.size()));
    for (std::size_t i = 0; i < scales.size(); ++i)
      result.mutable_at(static_cast<py::ssize_t>(i)) = scales[i].logarithmic;
    return result;
  }

 private:
  std::unique_ptr<Evaluation> evaluation_;
  int number_ = 0;
};

}  // namespace fabseq
