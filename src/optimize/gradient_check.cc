#include "fabseq/optimize/gradient_check.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/optimize/run_output.h"
#include "fabseq/optimize/tasks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace fabseq {

namespace {

/// A number in [-1, 1] that depends on the element's global position only.
double pseudo_random(std::int64_t number) {
  auto bits = static_cast<std::uint64_t>(number) + 0x9e3779b97f4a7c15ULL;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9ULL;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebULL;
  bits ^= bits >> 31;
  return 2.0 * static_cast<double>(bits >> 11) / 9007199254740992.0 - 1.0;
}

template <int Dim>
std::vector<double> direction(const Part<Dim>& part) {
  const Grid<Dim>& grid = part.grid();
  std::vector<double> result;
  for (const int element : part.elements())
    result.push_back(pseudo_random(grid.all_elements().offset(grid.owned_elements().index(element))));
  return result;
}

/// The design moved by `step` along the direction, on the optimizer's scale, away from the bounds.
std::vector<double> moved(const std::vector<double>& design, const std::vector<double>& along, double step,
                          const DesignSpace& space) {
  std::vector<double> result(design.size());
  for (std::size_t i = 0; i < design.size(); ++i)
    result[i] = space.from_unit(space.to_unit(design[i]) + step * along[i]);
  return result;
}

}  // namespace

double GradientError::best() const { return *std::min_element(relative.begin(), relative.end()); }

double GradientCheck::worst() const {
  double result = 0.0;
  for (const GradientError& error : errors) result = std::max(result, error.best());
  return result;
}

std::string GradientCheck::csv() const {
  std::ostringstream text;
  text.precision(10);
  text << "name,type,value,adjoint,step,difference,relative_error\n";
  for (const GradientError& error : errors)
    for (std::size_t s = 0; s < steps.size(); ++s)
      text << error.name << ',' << error.type << ',' << error.value << ',' << error.adjoint << ',' << steps[s]
           << ',' << error.differences[s] << ',' << error.relative[s] << '\n';
  return text.str();
}

Json GradientCheck::json() const {
  Json list = Json::array();
  for (const GradientError& error : errors)
    list.append(Json::object({{"name", error.name},
                              {"type", error.type},
                              {"value", error.value},
                              {"adjoint", error.adjoint},
                              {"differences", error.differences},
                              {"relative_errors", error.relative},
                              {"best", error.best()}}));
  return Json::object({{"steps", steps}, {"worst", worst()}, {"components", list}});
}

template <int Dim>
GradientCheck check_gradients(const Setup<Dim>& setup, Problem<Dim>& problem, Pipeline<Dim>& pipeline,
                              const std::vector<double>& design) {
  const DesignSpace space = pipeline.sequence().space();
  const std::vector<double> along = setup.groups.share(direction(setup.part));
  const auto run = [&](const std::vector<double>& x) {
    return pipeline.run(x, setup.layer_count, setup.first_beta(), false);
  };
  const auto state = run(design);
  const auto values = pipeline.values(problem.responses(), state);
  std::vector<GradientRow> rows;
  GradientCheck check;
  for (std::size_t r = 0; r < values.size(); ++r)
    for (std::size_t c = 0; c < values[r].size(); ++c) {
      rows.push_back({{static_cast<int>(r), static_cast<int>(c), 1.0}});
      GradientError& error = check.errors.emplace_back();
      error.name = problem.component_name(r, c);
      error.type = problem.responses()[r]->type();
      error.value = values[r][c];
    }
  const auto gradients = pipeline.gradients(problem.responses(), state, rows);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    double product = 0.0;
    for (std::size_t i = 0; i < design.size(); ++i)
      product += gradients[row][i] * space.slope(design[i]) * along[i];
    check.errors[row].adjoint = sum(setup.world(), product);
  }
  for (double step = 1e-1; step > 0.5e-7; step /= std::sqrt(10.0)) {
    check.steps.push_back(step);
    const auto ahead = pipeline.values(problem.responses(), run(moved(design, along, step, space)));
    const auto behind = pipeline.values(problem.responses(), run(moved(design, along, -step, space)));
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const auto [response, component, weight] = rows[row][0];
      GradientError& error = check.errors[row];
      error.differences.push_back((ahead[response][component] - behind[response][component]) / (2.0 * step));
      error.relative.push_back(std::abs(error.differences.back() - error.adjoint) / std::abs(error.adjoint));
    }
  }
  return check;
}

template <int Dim>
void run_check_gradients(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer) {
  Pipeline<Dim> pipeline(setup, make_sequence(setup, gradient_check_tolerance), gradient_check_tolerance,
                         timer);
  Problem<Dim> problem(setup);
  if (!pipeline.sequence().has_design()) {
    print("this sequence has no design variables: there are no gradients to check");
    return;
  }
  std::vector<double> design = starting_design(setup, pipeline.sequence(), command_line);
  // Steps must not end on a bound: the design keeps a tenth of the range from both.
  const DesignSpace space = pipeline.sequence().space();
  for (double& value : design) value = space.from_unit(std::clamp(space.to_unit(value), 0.1, 0.9));
  const OutputDirectory directory = make_output_directory(setup, command_line);
  const GradientCheck check = check_gradients(setup, problem, pipeline, design);
  directory.write("gradient_check.csv", check.csv());
  directory.write("gradient_check.json", check.json().dump(2) + "\n");
  directory.write("gradient_check.svg", check.svg("Gradients of " + setup.config.name));
  print("component             type                     adjoint   best relative error");
  for (const GradientError& error : check.errors) {
    char line[160];
    std::snprintf(line, sizeof line, "%-20s  %-18s %14.6e   %.1e", error.name.c_str(), error.type.c_str(),
                  error.adjoint, error.best());
    print(line);
  }
  char line[80];
  std::snprintf(line, sizeof line, "largest: %.1e; table and plot in ", check.worst());
  print(line + directory.path());
}

template GradientCheck check_gradients<2>(const Setup<2>&, Problem<2>&, Pipeline<2>&,
                                          const std::vector<double>&);
template GradientCheck check_gradients<3>(const Setup<3>&, Problem<3>&, Pipeline<3>&,
                                          const std::vector<double>&);
template void run_check_gradients<2>(const CommandLine&, const Setup<2>&, PhaseTimer&);
template void run_check_gradients<3>(const CommandLine&, const Setup<3>&, PhaseTimer&);

}  // namespace fabseq
