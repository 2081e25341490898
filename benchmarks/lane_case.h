// SPDX-License-Identifier: MIT
/// \file
/// Layer systems of drawn parts, for the benchmarks of the lane engine.
#pragma once

#include "cg/lane_cg.h"
#include "fabseq/fem/element_matrices.h"
#include "fabseq/grid/grid.h"
#include "kernels/lane_array.h"
#include "multigrid/lane_hierarchy.h"

#include <array>
#include <functional>
#include <memory>
#include <vector>

namespace benchmarks {

/// A part on the lowest face of a box, and the order in which it is built.
struct DrawnPart {
  fabseq::Point<3> size{2.0, 1.0, 2.0};
  fabseq::Index<3> elements{80, 40, 80};
  /// Whether an element, given by centre and index, is in the part: the V-shape of configs/v_shape.json.
  std::function<bool(const fabseq::Point<3>&, const fabseq::Index<3>&)> contains = [](const auto& at, auto&) {
    return (at[2] < 0.6 || at[0] > 1.2) && at[2] > at[0] - 1.0;
  };
  /// Its pseudo-time: tilted planes.
  std::function<double(const fabseq::Point<3>&, const fabseq::Index<3>&)> time = [](const auto& at, auto&) {
    return 0.35 * at[2] + 0.15 * at[0];
  };
  bool quiet_void = false;
  double poisson = 0.3;
  int layer_count = 25;
  double sharpness = 100.0;  ///< of the smooth layers
};

/// Eight layers of a drawn part, from the first to the last.
class LaneCase {
 public:
  static constexpr int lanes = 8;
  using Problem = fabseq::LaneElasticityProblem<3>;

  /// Collective on `comm`.
  LaneCase(MPI_Comm comm, const DrawnPart& part);

  fabseq::LaneHierarchy<3>& hierarchy() { return *hierarchy_; }
  const Problem& problem() const { return problem_; }
  /// Stiffness factors, [element][lane].
  void fill(fabseq::LaneArray& coefficients) const;
  /// Forces of the inherent strain of each layer. Collective.
  fabseq::LaneArray load();
  /// Elements of the part over those of the box. Collective.
  double filled() const;

 private:
  struct Element {
    fabseq::Index<3> index{};
    double time = 0.0;    ///< pseudo-time
    bool in_part = true;  ///< false: void that is quietly there
  };

  /// How much of an element is there after a layer (docs/formulation.md 3.1).
  double stage_density(const Element& element, int layer) const;

  DrawnPart part_;
  fabseq::Grid<3> grid_;
  Problem problem_;
  std::array<int, lanes> layers_{};  ///< of each lane, from 1
  std::vector<Element> elements_;
  std::unique_ptr<fabseq::LaneHierarchy<3>> hierarchy_;
};

/// A case with its solver, whose coefficients are filled in. Collective on `comm`.
struct LaneSystem {
  using Solver = fabseq::LaneCg<LaneCase::Problem, LaneCase::lanes>;

  LaneSystem(MPI_Comm comm, const DrawnPart& part, const fabseq::LaneCycle& cycle = {})
      : lane_case(comm, part), solver(lane_case.hierarchy(), lane_case.problem(), cycle) {
    lane_case.fill(solver.matrix().coefficients());
  }

  LaneCase lane_case;
  Solver solver;
};

/// Sharpness that an optimization of 25 layers begins and ends with.
constexpr double first_sharpness = 100.0, last_sharpness = 337.5;
/// The V-shape with this many elements along x, and the whole of its box.
DrawnPart drawn_v_shape(int elements, double sharpness);
DrawnPart drawn_box(int elements);

}  // namespace benchmarks
