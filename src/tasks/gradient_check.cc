// SPDX-License-Identifier: MIT
#include "tasks/gradient_check.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "fabseq/optimize/problem.h"
#include "fabseq/output/task_directory.h"
#include "fabseq/tasks/starting_design.h"
#include "fabseq/tasks/tasks.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// A number in [-1, 1] that depends on the variable's global position only.
double pseudo_random(std::int64_t number) {
  auto bits = static_cast<std::uint64_t>(number) + 0x9e3779b97f4a7c15ULL;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9ULL;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebULL;
  bits ^= bits >> 31;
  return 2.0 * static_cast<double>(bits >> 11) / 9007199254740992.0 - 1.0;
}

/// A direction in the space of one kind of variables; on the optimizer's scale for the field.
struct Direction {
  std::string variables;
  Design along;  ///< zero for all other kinds
};

template <int Dim>
std::vector<Direction> directions(const Model<Dim>& model, const Design& design) {
  std::vector<Direction> result;
  const Design zero{std::vector<double>(design.field.size(), 0.0),
                    std::vector<double>(design.layer_variables.size(), 0.0)};
  if (any(model.world(), !design.field.empty())) {
    std::vector<double> field;
    for (std::size_t i = 0; i < model.design_support.size(); ++i)
      field.push_back(pseudo_random(model.design_support.number(i)));
    result.push_back({"design", zero});
    result.back().along.field = model.groups.share(field);
  }
  if (!design.layer_variables.empty()) {
    const LayerVariables& variables = model.layers->variables();
    result.push_back({variables.name, zero});
    for (std::size_t j = 0; j < variables.count(); ++j)
      result.back().along.layer_variables[j] =
          (variables.upper[j] - variables.lower[j]) * pseudo_random(static_cast<std::int64_t>(j));
  }
  return result;
}

/// The design moved by `step` along the direction, away from the bounds.
Design moved(const Design& design, const Design& along, double step, const DesignSpace& space,
             const LayerVariables& variables) {
  Design result = design;
  for (std::size_t i = 0; i < design.field.size(); ++i)
    if (along.field[i] != 0.0)
      result.field[i] = space.of(i).from_unit(space.of(i).to_unit(design.field[i]) + step * along.field[i]);
  for (std::size_t j = 0; j < design.layer_variables.size(); ++j)
    result.layer_variables[j] = std::clamp(design.layer_variables[j] + step * along.layer_variables[j],
                                           variables.lower[j], variables.upper[j]);
  return result;
}

/// Derivative along a direction; the same on all ranks.
double slope_along(MPI_Comm comm, const Design& gradient, const Design& design, const Design& along,
                   const DesignSpace& space) {
  double product = 0.0;
  for (std::size_t i = 0; i < design.field.size(); ++i)
    product += gradient.field[i] * space.of(i).slope(design.field[i]) * along.field[i];
  product = sum(comm, product);
  for (std::size_t j = 0; j < design.layer_variables.size(); ++j)
    product += gradient.layer_variables[j] * along.layer_variables[j];
  return product;
}

constexpr double step_ratio_squared = 10.0;  ///< of a step and the next shorter one

double relative_error(double difference, double adjoint) {
  return difference == adjoint ? 0.0 : std::abs(difference - adjoint) / std::abs(adjoint);
}

/// Compares along pseudo-random directions, one for each kind of variables, the same on any number of ranks.
/// Collective.
template <int Dim>
GradientCheck check_gradients(const Model<Dim>& model, Problem<Dim>& problem, Pipeline<Dim>& pipeline,
                              const Design& design) {
  const DesignSpace space = model.space_of_share(pipeline.sequence());
  const auto run = [&](const Design& x) { return pipeline.run(x, model.layers->traits().first_beta, false); };
  const auto state = run(design);
  const auto values = pipeline.values(problem.responses_and_functionals(), state);
  const std::vector<GradientRow> rows = all_components(values);
  const auto gradients = pipeline.gradients(problem.responses_and_functionals(), state, rows);
  GradientCheck check;
  for (double step = 1e-1; step > 0.5e-7; step /= std::sqrt(step_ratio_squared)) check.steps.push_back(step);
  for (const auto& [variables, along] : directions(model, design)) {
    const std::size_t first = check.errors.size();
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const auto [response, component, weight] = rows[row][0];
      GradientError& error = check.errors.emplace_back();
      error.name = problem.component_name(response, component);
      error.type = problem.types()[response];
      error.variables = variables;
      error.value = values[response][component];
      error.adjoint = slope_along(model.world(), gradients[row], design, along, space);
    }
    for (const double step : check.steps) {
      const auto values_at = [&, &way = along](double distance) {
        return pipeline.values(problem.responses_and_functionals(),
                               run(moved(design, way, distance, space, model.layers->variables())));
      };
      const auto ahead = values_at(step), behind = values_at(-step);
      for (std::size_t row = 0; row < rows.size(); ++row) {
        const auto [response, component, weight] = rows[row][0];
        GradientError& error = check.errors[first + row];
        error.differences.push_back((ahead[response][component] - behind[response][component]) /
                                    (2.0 * step));
        error.relative.push_back(relative_error(error.differences.back(), error.adjoint));
      }
    }
  }
  return check;
}

/// Steps must not end on a bound: the field keeps a tenth of the range from both, the layers' variables,
/// which may be closer to each other, a thousandth.
void keep_off_the_bounds(Design& design, const DesignSpace& space, const LayerVariables& variables) {
  for (std::size_t i = 0; i < design.field.size(); ++i)
    design.field[i] = space.of(i).from_unit(std::clamp(space.of(i).to_unit(design.field[i]), 0.1, 0.9));
  for (std::size_t j = 0; j < design.layer_variables.size(); ++j) {
    const double margin = 1e-3 * (variables.upper[j] - variables.lower[j]);
    design.layer_variables[j] =
        std::clamp(design.layer_variables[j], variables.lower[j] + margin, variables.upper[j] - margin);
  }
}

}  // namespace

std::vector<double> GradientError::extrapolated() const {
  std::vector<double> result;
  for (std::size_t s = 1; s < differences.size(); ++s)
    result.push_back((step_ratio_squared * differences[s] - differences[s - 1]) / (step_ratio_squared - 1.0));
  return result;
}

double GradientError::best() const {
  double result = *std::min_element(relative.begin(), relative.end());
  for (const double difference : extrapolated())
    result = std::min(result, relative_error(difference, adjoint));
  return result;
}

double GradientCheck::worst() const {
  double result = 0.0;
  for (const GradientError& error : errors) result = std::max(result, error.best());
  return result;
}

std::string GradientCheck::csv() const {
  std::string text = "name,type,variables,value,adjoint,step,difference,relative_error\n";
  for (const GradientError& error : errors)
    for (std::size_t s = 0; s < steps.size(); ++s)
      text += error.name + ',' + error.type + ',' + error.variables +
              formatted(",%.10g,%.10g,%.10g,%.10g,%.10g\n", error.value, error.adjoint, steps[s],
                        error.differences[s], error.relative[s]);
  return text;
}

Json GradientCheck::json() const {
  Json list = Json::array();
  for (const GradientError& error : errors)
    list.push_back(Json::object({{"name", error.name},
                                 {"type", error.type},
                                 {"variables", error.variables},
                                 {"value", error.value},
                                 {"adjoint", error.adjoint},
                                 {"differences", error.differences},
                                 {"relative_errors", error.relative},
                                 {"extrapolated", error.extrapolated()},
                                 {"best", error.best()}}));
  return Json::object({{"name", name}, {"steps", steps}, {"worst", worst()}, {"components", list}});
}

template <int Dim>
void run_check_gradients(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer) {
  constexpr double tolerance = 1e-12;
  Pipeline<Dim> pipeline(setup, tolerance, timer);
  pipeline.set_region(setup.config.solver.region_of_evaluations());
  Problem<Dim> problem(setup, setup.config.optimizer.constraint_margin);
  if (!pipeline.sequence().has_design()) {
    print("this sequence has no design variables: there are no gradients to check");
    return;
  }
  Design design = starting_design(setup, pipeline.sequence(), command_line);
  keep_off_the_bounds(design, setup.space_of_share(pipeline.sequence()), setup.layers->variables());
  const OutputDirectory directory = make_output_directory(setup, command_line);
  const StopFile stop_file(setup.groups.domain(), directory.file("stop"));
  GradientCheck check = check_gradients(setup, problem, pipeline, design);
  check.name = setup.config.name;
  directory.write("gradient_check.csv", check.csv());
  directory.write("gradient_check.json", to_text(check.json(), 2) + "\n");
  print("component             type                    variables           adjoint   best relative error");
  for (const GradientError& error : check.errors)
    print(formatted("%-20s  %-22s  %-12s %14.6e   %.1e", error.name.c_str(), error.type.c_str(),
                    error.variables.c_str(), error.adjoint, error.best()));
  print(formatted("largest: %.1e; table in ", check.worst()) + directory.path());
  print("picture: fabseq-tools plot-gradients " + directory.path());
}

FABSEQ_INSTANTIATE_FUNCTION(run_check_gradients);

}  // namespace fabseq
