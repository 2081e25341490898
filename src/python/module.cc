// SPDX-License-Identifier: MIT
/// The Python module `fabseq` (docs/developer/library.md): a config's values, gradients and fields as NumPy
/// arrays. All of it is collective on the ranks of the run, but the plain properties.
#include "fabseq/base/plain_numbers.h"
#include "python/problem.h"

#include <exception>
#include <optional>
#include <pybind11/pybind11.h>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

/// The problem that a method was called with. Python can make an object without its __init__.
PythonProblem& problem_of(const py::object& self) {
  if (!py::isinstance<PythonProblem>(self))
    throw py::type_error("found " + shown_object(self) + "; allowed: a fabseq.Problem");
  auto* const instance = reinterpret_cast<py::detail::instance*>(self.ptr());  // NOLINT: pybind11's own way
  if (!instance->get_value_and_holder().holder_constructed())
    throw py::type_error("found a fabseq.Problem without __init__; allowed: fabseq.Problem(config)");
  return self.cast<PythonProblem&>();
}

/// Does a collective call: `prepare(arguments)` reads what this rank was given and notes what must be equal
/// on all; `work(evaluation)` gives the result.
template <class Prepare, class Work>
auto together(const char* name, const py::object& self, Prepare prepare, Work work) {
  if (!runtime().agreement || mpi_has_ended()) (void)problem_of(self).evaluation();  // throws
  std::optional<decltype(work(std::declval<Evaluation&>()))> result;
  Evaluation* evaluation = nullptr;
  runtime().agreement->run(
      [&] {
        const PythonProblem& problem = problem_of(self);
        evaluation = &problem.evaluation();
        Call call{name, problem.number()};
        prepare(call.arguments);
        return call;
      },
      [&] { result.emplace(work(*evaluation)); });
  return std::move(*result);
}

py::array gather(const py::object& self, const py::object& share) {
  std::vector<double> own;
  return together(
      "gather()", self, [&](Json&) { own = numbers_of("share", share); },
      [&](Evaluation& of) { return array_of(of.entries().gather(own)); });
}

py::array share_of(const py::object& self, const py::object& whole) {
  std::vector<double> all;
  return together(
      "share()", self, [&](Json&) { all = numbers_of("whole", whole); },
      [&](Evaluation& of) { return array_of(of.entries().share_of(all)); });
}

py::dict evaluate(const py::object& self, const py::object& design, const py::object& beta) {
  std::vector<double> own;
  std::optional<double> sharpness;
  const auto prepare = [&](Json& arguments) {
    own = numbers_of("design", design);
    if (!beta.is_none()) {
      if (PyNumber_Check(beta.ptr()) == 0)
        throw py::type_error("beta: found " + shown_object(beta) + "; allowed: a number, or None");
      sharpness = py::float_(beta).cast<double>();
    }
    arguments["beta"] = sharpness ? Json(*sharpness) : Json();
  };
  return together("evaluate()", self, prepare, [&](Evaluation& of) {
    py::dict result;
    for (const NamedValue& value : of.evaluate(own, sharpness)) result[py::str(value.name)] = value.value;
    return result;
  });
}

py::dict gradients(const py::object& self, const py::args& names) {
  std::vector<std::string> asked;
  const auto prepare = [&](Json& arguments) {
    for (const py::handle name : names) {
      if (!py::isinstance<py::str>(name))
        throw py::type_error("gradients: found " + shown_object(name) + "; allowed: names of the values");
      asked.push_back(name.cast<std::string>());
    }
    arguments["names"] = asked;
  };
  return together("gradients()", self, prepare, [&](Evaluation& of) {
    py::dict result;
    for (const auto& [name, gradient] : of.gradients(asked)) result[py::str(name)] = array_of(gradient);
    return result;
  });
}

py::dict fields(const py::object& self) {
  return together(
      "fields()", self, [](Json&) {},
      [](Evaluation& of) {
        py::dict result;
        for (const WholeField& field : of.fields())
          result[py::str(field.name)] = py::array_t<double>(field.shape, field.values.data());
        return result;
      });
}

/// Ends the runtime before Python takes its modules apart. Whoever has begun MPI ends it later. Of several
/// ranks, the fork of a process leaves all of it to that process.
void end_runtime() {
  Runtime& now = runtime();
  now.ended = true;
  const bool several = now.session && !mpi_has_ended() && size_of(PETSC_COMM_WORLD) > 1;
  if (several && now.process != ::getpid()) {
    while (!now.open.empty()) now.open.front()->abandon();
    (void)now.agreement.release();
    (void)now.session.release();
    return;
  }
  if (several) now.agreement->end();
  while (!now.open.empty()) now.open.front()->close();
  let_go(now.agreement);
  let_go(now.session);
}

/// ValueError for what the user can mend, RuntimeError for a solver that fails.
void translate(std::exception_ptr error) {
  try {
    std::rethrow_exception(std::move(error));
  } catch (const SharedFailure&) {
    raise_in_python(failure_of(std::current_exception()));
  } catch (const Error&) {
    raise_in_python(failure_of(std::current_exception()));
  }
}

}  // namespace

}  // namespace fabseq

// NOLINTNEXTLINE: what the macro consists of is pybind11's
PYBIND11_MODULE(fabseq, module) {
  using fabseq::PythonProblem, fabseq::PlainNumbers, fabseq::problem_of;
  namespace py = pybind11;
  using plainly = py::call_guard<PlainNumbers>;  // Python's programs set any locale
  module.doc() = "Values, gradients and fields of fabseq's problems. All calls are collective on the ranks.";
  module.attr("__version__") = FABSEQ_VERSION;
  py::register_local_exception_translator(fabseq::translate);
  const auto property = [](auto member) {
    return py::cpp_function([member](const py::object& self) { return (problem_of(self).*member)(); });
  };
  py::class_<PythonProblem>(
      module, "Problem",
      "What a config optimizes. Arrays of designs and gradients are 1D and hold this "
      "rank's share of the variables, in the unit of the config, whatever the scale. What "
      "a call throws on one rank it throws on all.")
      .def(py::init<const py::object&, const py::object&>(), py::arg("config"), py::arg("set") = py::dict(),
           plainly(),
           "config: path of a config file, or a dict, whose paths are relative to the working directory. "
           "set: other values of keys, by dotted path. ValueError: what is wrong with the config.")
      .def_property_readonly("rank", property(&PythonProblem::rank), "Of this process among all, from 0.")
      .def_property_readonly("design", property(&PythonProblem::design), "The design that a run starts from.")
      .def_property_readonly("bounds", property(&PythonProblem::bounds), "Lowest and highest design.")
      .def_property_readonly("logarithmic", property(&PythonProblem::logarithmic),
                             "Which variables fabseq's own optimizer varies by their logarithms.")
      .def("evaluate", &fabseq::evaluate, py::arg("design"), py::arg("beta") = py::none(), plainly(),
           "Raw values of all components, by the names of summary.json. beta: sharpness of the layers; None: "
           "that of a run's first iteration.")
      .def("gradients", &fabseq::gradients, plainly(),
           "Gradients of these components, of all without names, at the design of the last evaluate().")
      .def("fields", &fabseq::fields, plainly(),
           "Fields of the last evaluate(), whole on every rank, with names and axes of result.h5: "
           "[z][y][x][component].")
      .def("gather", &fabseq::gather, py::arg("share"),
           "All ranks' shares as one array, whose order does not depend on the ranks.")
      .def("share", &fabseq::share_of, py::arg("whole"), "This rank's share of what gather() gives.")
      .def(
          "close", [](const py::object& self) { problem_of(self).close(); },
          "Frees all memory. The end of Python does so, too.");
  py::module_::import("atexit").attr("register")(py::cpp_function(&fabseq::end_runtime));
}
