// SPDX-License-Identifier: MIT
/// The Python module `fabseq` (docs/developer/library.md): a config's values, gradients and fields as NumPy
/// arrays. All of it is collective on the ranks of the run.
#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/one_line.h"
#include "fabseq/base/plain_numbers.h"
#include "fabseq/base/session.h"
#include "fabseq/config/command_line.h"
#include "python/evaluation.h"

#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

namespace py = pybind11;

/// The config of a path or a dict, with other values for some keys.
Config config_of(const py::object& config, const py::dict& set) {
  const py::object dumps = py::module_::import("json").attr("dumps");
  CommandLine command_line;
  command_line.task = Task::evaluate;
  for (const auto& [path, value] : set)
    command_line.overrides.emplace_back(py::str(path), dumps(value).cast<std::string>());
  if (py::isinstance<py::dict>(config)) {
    const std::string text = broadcast(PETSC_COMM_WORLD, dumps(config).cast<std::string>());
    const std::string directory = broadcast(PETSC_COMM_WORLD, std::filesystem::current_path().string());
    return read_config(PETSC_COMM_WORLD, parse_json(text, "config"), directory, command_line);
  }
  command_line.config_file = py::module_::import("os").attr("fspath")(config).cast<std::string>();
  return read_config(PETSC_COMM_WORLD, command_line);
}

class PythonProblem;

/// MPI and PETSc, from the first problem until Python ends, and the problems that are open.
struct Runtime {
  std::unique_ptr<Session> session;
  std::vector<PythonProblem*> open;  ///< in the order in which they were made
  bool ended = false;
};

Runtime& runtime() {
  static Runtime result;
  return result;
}

bool mpi_has_ended() {
  int finalized = 0;
  MPI_Finalized(&finalized);
  return finalized != 0;
}

/// Destroys an object with parts of PETSc. After the end of MPI it is too late for that: the memory is left
/// to the end of the process.
template <class Object>
void let_go(std::unique_ptr<Object>& object) {
  if (mpi_has_ended()) (void)object.release();
  object.reset();
}

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::span<const double> span_of(const Array& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}
py::array array_of(const std::vector<double>& values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

/// What Python sees as fabseq.Problem.
class PythonProblem {
 public:
  PythonProblem(const py::object& config, const py::dict& set) {
    if (runtime().ended || mpi_has_ended()) throw std::runtime_error("MPI has ended");
    if (!runtime().session) runtime().session = std::make_unique<Session>(std::vector<std::string>{"fabseq"});
    evaluation_ = make_evaluation(config_of(config, set));
    runtime().open.push_back(this);
  }
  PythonProblem(PythonProblem&&) = delete;
  ~PythonProblem() { close(); }

  void close() {
    std::erase(runtime().open, this);
    let_go(evaluation_);
  }
  Evaluation& evaluation() const {
    if (!evaluation_) throw std::runtime_error("the problem is closed");
    return *evaluation_;
  }

  int rank() const {
    (void)evaluation();
    return rank_of(PETSC_COMM_WORLD);
  }
  py::array design() const { return array_of(evaluation().start()); }
  py::array gather(const Array& share) const {
    return array_of(evaluation().entries().gather(span_of(share)));
  }
  py::array share(const Array& whole) const {
    return array_of(evaluation().entries().share_of(span_of(whole)));
  }

  py::dict evaluate(const Array& design, std::optional<double> beta) const {
    py::dict result;
    for (const NamedValue& value : evaluation().evaluate(span_of(design), beta))
      result[py::str(value.name)] = value.value;
    return result;
  }
  py::dict gradients(const py::args& names) const {
    py::dict result;
    for (const auto& [name, gradient] : evaluation().gradients(names.cast<std::vector<std::string>>()))
      result[py::str(name)] = array_of(gradient);
    return result;
  }
  py::dict fields() const {
    py::dict result;
    for (const WholeField& field : evaluation().fields())
      result[py::str(field.name)] = py::array_t<double>(field.shape, field.values.data());
    return result;
  }
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
};

/// Before Python takes its modules apart. Whoever has begun MPI ends it later.
void end_runtime() {
  runtime().ended = true;
  while (!runtime().open.empty()) runtime().open.front()->close();
  let_go(runtime().session);
}

/// ValueError for what the user can mend, RuntimeError for a solver that fails.
void translate(std::exception_ptr error) {
  try {
    std::rethrow_exception(std::move(error));
  } catch (const InputError& refusal) {
    PyErr_SetString(PyExc_ValueError, one_line(refusal.what()).c_str());
  } catch (const Error& failure) {
    PyErr_SetString(PyExc_RuntimeError, one_line(failure.what()).c_str());
  }
}

}  // namespace

}  // namespace fabseq

// NOLINTNEXTLINE: what the macro consists of is pybind11's
PYBIND11_MODULE(fabseq, module) {
  using fabseq::PythonProblem, fabseq::PlainNumbers;
  namespace py = pybind11;
  using plainly = py::call_guard<PlainNumbers>;  // Python's programs set any locale
  module.doc() = "Values, gradients and fields of fabseq's problems. All calls are collective on the ranks.";
  module.attr("__version__") = FABSEQ_VERSION;
  py::register_local_exception_translator(fabseq::translate);
  py::class_<PythonProblem>(module, "Problem",
                            "What a config optimizes. Arrays of designs and gradients are 1D and hold this "
                            "rank's share of the variables, in the unit of the config, whatever the scale.")
      .def(py::init<const py::object&, const py::dict&>(), py::arg("config"), py::arg("set") = py::dict(),
           plainly(),
           "config: path of a config file, or a dict, whose paths are relative to the working directory. "
           "set: other values of keys, by dotted path. ValueError: what is wrong with the config.")
      .def_property_readonly("rank", &PythonProblem::rank, "Of this process among all, from 0.")
      .def_property_readonly("design", &PythonProblem::design, "The design that a run starts from.")
      .def_property_readonly("bounds", &PythonProblem::bounds, "Lowest and highest design.")
      .def_property_readonly("logarithmic", &PythonProblem::logarithmic,
                             "Which variables fabseq's own optimizer varies by their logarithms.")
      .def("evaluate", &PythonProblem::evaluate, py::arg("design"), py::arg("beta") = py::none(), plainly(),
           "Raw values of all components, by the names of summary.json. beta: sharpness of the layers; None: "
           "that of a run's first iteration.")
      .def("gradients", &PythonProblem::gradients, plainly(),
           "Gradients of these components, of all without names, at the design of the last evaluate().")
      .def("fields", &PythonProblem::fields, plainly(),
           "Fields of the last evaluate(), whole on every rank, with names and axes of result.h5: "
           "[z][y][x][component].")
      .def("gather", &PythonProblem::gather, py::arg("share"),
           "All ranks' shares as one array, whose order does not depend on the ranks.")
      .def("share", &PythonProblem::share, py::arg("whole"), "This rank's share of what gather() gives.")
      .def("close", &PythonProblem::close, "Frees all memory. The end of Python does so, too.");
  py::module_::import("atexit").attr("register")(py::cpp_function(&fabseq::end_runtime));
}
