// SPDX-License-Identifier: MIT
#include "sequence/guided_problem.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/verdict.h"
#include "fabseq/sequence/element_means.h"
#include "sequence/start_domain.h"
#include "sequence/time_adjoints.h"

#include <utility>

namespace fabseq {

template <int Dim>
GuidedProblem<Dim>::GuidedProblem(const Part<Dim>& part, double void_diffusivity,
                                  const MakeSolver& make_solver, MPI_Comm across, int lanes)
    : part_(part),
      element_(part.grid().spacing(), part.grid().domain().thickness, 0.0),
      domain_(start_domain(part)),
      diffusivity_(part.expand(std::vector<double>(part.elements().size(), 1.0), void_diffusivity)),
      solver_(make_solver(domain_, /*lumped=*/true)),
      forward_(*solver_, across),
      lanes_(lanes) {}

template <int Dim>
void GuidedProblem<Dim>::set_up() {
  if (!is_set_up_) solver_->set_operator(diffusivity_, /*reaction=*/0.0);
  is_set_up_ = true;
}

template <int Dim>
void GuidedProblem<Dim>::start_cold() {
  forward_.start_cold();
  is_set_up_ = false;
}

template <int Dim>
std::vector<double> GuidedProblem<Dim>::times(std::span<const double> vectors) {
  // v is constant in an element, and the mean of grad N_i over a box is its value at the centre: the load is
  // the transpose of the gradient at centres.
  TimeDerivatives weighted{std::vector<double>(part_.elements().size(), 0.0),
                           {vectors.begin(), vectors.end()}};
  for (double& component : weighted.gradient) component *= part_.grid().element_volume();
  const LaneVector load = pull_back_means<Dim>(part_, element_, {&weighted, 1});
  return forward_.solve(
      load, [&] { set_up(); }, "the solve for the guided time");
}

template <int Dim>
std::vector<std::vector<double>> GuidedProblem<Dim>::pull_back(std::span<const TimeDerivatives> rows) {
  std::vector<std::vector<double>> result;
  // dJ/dv_e = V_e grad lambda at the centre: K and the load's map are symmetric to those of times().
  const auto add = [&](const LaneVector& adjoints) {
    for (std::vector<double>& gradient : element_gradients<Dim>(part_, element_, adjoints)) {
      for (double& component : gradient) component *= part_.grid().element_volume();
      result.push_back(std::move(gradient));
    }
  };
  set_up();
  adjoint_iterations_ =
      solve_time_adjoints<Dim>(part_, element_, *solver_, rows, lanes_, add, "an adjoint of the guided time");
  if (solver_->saves_memory()) solver_->release_memory();
  return result;
}

FABSEQ_INSTANTIATE_CLASS(GuidedProblem);

}  // namespace fabseq
