// SPDX-License-Identifier: MIT
/// \file
/// What the design that a config starts from comes to, beside planar layers, and how steep the objective is
/// there: all that a method of optimization of your own needs to ask.
///
///     mpirun -np 2 start_value CONFIG.json
#include <fabseq/base/error.h>
#include <fabseq/base/mpi.h>
#include <fabseq/base/session.h>
#include <fabseq/config/command_line.h>
#include <fabseq/optimize/problem.h>
#include <fabseq/tasks/optimization.h>
#include <fabseq/tasks/starting_design.h>
#include <numeric>
#include <string>

namespace {

template <int Dim>
void print_start(const fabseq::Config& config) {
  fabseq::PhaseTimer timer;
  // Grid, part, node sets, layers. Ranks that share the layers have copies of them (docs/architecture.md).
  const fabseq::Setup<Dim> setup(PETSC_COMM_WORLD, config);
  // From a design to displacements, and from values back to gradients.
  fabseq::Pipeline<Dim> pipeline(setup, config.solver.finest_tolerance(), timer);
  const fabseq::Problem<Dim> problem(setup, config.optimizer.constraint_margin);

  const fabseq::Design start = starting_design(setup, pipeline.sequence(), fabseq::CommandLine());
  const auto state = pipeline.run(start, setup.layers->traits().first_beta, setup.binary());
  const auto values = problem.describe(pipeline.values(problem.responses(), state));
  const auto planar = planar_baseline(setup, problem, timer).responses;
  for (const auto& value : values) {
    std::string line = value.name + " (" + value.type + "): " + std::to_string(value.value);
    for (const auto& other : planar)  // which may have fewer layers, and with them fewer components
      if (other.name == value.name) line += ", planar " + std::to_string(other.value);
    fabseq::print(line);
  }

  // A gradient for each row; a row is a weighted sum of components. Each rank has a share of the variables.
  const auto gradients = pipeline.gradients(problem.responses(), state, {{{.response = 0, .component = 0}}});
  const auto& share = gradients[0].field;
  const double own = std::inner_product(share.begin(), share.end(), share.begin(), 0.0);
  fabseq::print("square of the gradient of " + problem.component_name(0, 0) + ": " +
                std::to_string(fabseq::sum(setup.world(), own)));
}

}  // namespace

int main(int argc, char** argv) {
  // Starts and ends MPI and PETSc, and makes a line on stderr and an exit status of what is thrown.
  return fabseq::run_session({argv[0]}, [&] {
    if (argc != 2) throw fabseq::InputError("found other arguments; allowed: start_value CONFIG.json");
    fabseq::CommandLine command_line;
    command_line.config_file = argv[1];
    const fabseq::Config config = read_config(PETSC_COMM_WORLD, command_line);
    return config.dimension() == 2 ? print_start<2>(config) : print_start<3>(config);
  });
}
