/// \file
/// The systems that the solver's parts are measured on.
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/grid/grid.h"
#include "fabseq/solve/lane_hierarchy.h"
#include "fabseq/solve/lane_operator.h"

#include <memory>
#include <vector>

namespace benchmarks {

/// Eight layers of the 25 of configs/v_shape.json, from the first to the last, as tilted planes. Every rank has
/// a whole part of its own.
class GradedPart {
 public:
  static constexpr int lanes = 8;
  using Problem = fabseq::LaneElasticityProblem<3>;

  enum class Shape { v, box };
  /// Sharpness that an optimization of 25 layers begins and ends with.
  static constexpr double first_sharpness = 100.0, last_sharpness = 337.5;
  /// Without the elements that the shape leaves out.
  GradedPart(Shape shape, const fabseq::Index<3>& elements, double sharpness = first_sharpness);

  fabseq::LaneHierarchy<3>& hierarchy() { return *hierarchy_; }
  const Problem& problem() const { return problem_; }
  /// Stiffness factors, [element][lane].
  void fill(fabseq::LaneArray& coefficients) const;
  /// Forces of the inherent strain of each layer.
  fabseq::LaneArray load() const;

 private:
  struct Element {
    fabseq::Index<3> index{};
    double time = 0.0;  ///< pseudo-time
  };

  /// How much of an element is there after a layer (docs/formulation.md 3).
  double stage_density(const Element& element, int layer) const;

  fabseq::Grid<3> grid_;
  double sharpness_;
  Problem problem_;
  std::vector<Element> elements_;
  std::unique_ptr<fabseq::LaneHierarchy<3>> hierarchy_;
};

}  // namespace benchmarks
