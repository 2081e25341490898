// SPDX-License-Identifier: MIT
/// \file
/// An elastic body that nothing holds, by the lane engine.
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/lanes/lane_layout.h"
#include "fabseq/lanes/lane_multigrid.h"
#include "fabseq/lanes/spectrum_estimate.h"
#include "fabseq/solve/reference/assembled_system.h"

#include <array>
#include <span>
#include <vector>

namespace fabseq {

/// Solves K u = f for loads that balance themselves, u without a mean rigid motion: flexible conjugate
/// gradients in the space without rigid motions, lane multigrid in single precision. No level is held
/// anywhere; the last one is a little stiffer on its diagonal, for its factorization. The operator is set up
/// once. Collective on the grid's communicator.
template <int Dim>
class LaneFreeBody {
 public:
  /// `domain`: its elements count, its supports do not; one piece by nodes that hold each other. `stiffness`:
  /// factor of each element. The grid must outlive the solver.
  LaneFreeBody(const Grid<Dim>& grid, const SystemDomain& domain, double poisson, const LaneCycle& cycle,
               std::span<const double> stiffness);

  /// Loads and displacements [owned node][component]; 0 at nodes of no element. Does not throw if it does not
  /// converge. Throws Stopped, on all ranks in the same iteration, if one was asked to stop.
  SolveReport solve(std::span<const double> load, std::span<double> displacement, double tolerance,
                    int max_iterations);

 private:
  using Problem = LaneElasticityProblem<Dim>;
  static constexpr int motions = Dim * (Dim + 1) / 2;
  using Factor = std::array<std::array<double, motions>, motions>;

  /// Where the iteration is, apart from the vectors.
  struct State {
    int iteration = 0;
    double start = 0.0;   ///< |M f|^2
    double length = 0.0;  ///< |u|^2, this rank's part
    double energy = 0.0;  ///< p . K p of the last step
    SpectrumEstimate spectrum;
    SolveReport report;
  };
  void locate_nodes();
  void weigh_nodes();
  double motion(int number, std::int64_t node, int component) const;
  template <class Weight>
  Factor factor_motions(Weight&& weight) const;
  template <class Real, class Weight>
  void project(LaneValues<Real>& values, const Factor& factor, Weight&& weight) const;
  /// Takes the mean rigid motion out of a displacement, and the resultants out of forces.
  void remove_motions(LaneValues<float>& displacement) const;
  void balance(LaneArray& forces) const;
  void iterate(State& state, LaneArray& rest, LaneArray& solution, double tolerance, int max_iterations);
  bool judge(State& state, double size, double length, double tolerance) const;

  static SystemDomain without_supports(SystemDomain domain);

  LaneCycle cycle_;
  Problem problem_;
  LaneHierarchy<Dim> hierarchy_;
  LaneLayout<Dim> layout_;
  LaneOperator<Problem, 1> matrix_;
  LaneMultigrid<Problem, 1, float> multigrid_;
  bool positive_;
  std::vector<double> positions_;  ///< [node][axis], from the centre, in units of the grid's extent
  LaneArray stiffness_;            ///< of the elements around each node
  Factor of_displacements_{},
      of_forces_{};  ///< lower Cholesky factors of R^T R and R^T W R, W that stiffness
  LaneArray direction_, image_;
  LaneValues<float> rounded_rest_, preconditioned_;
};

extern template class LaneFreeBody<2>;
extern template class LaneFreeBody<3>;

}  // namespace fabseq
