// SPDX-License-Identifier: MIT
#include "sequence/repeated_averaging.h"

#include "fabseq/sequence/element_means.h"

#include <cmath>

namespace fabseq {

namespace {

/// Number of passes for a radius. A pass has the kernel (1/4, 1/2, 1/4) along each axis, whose variance is
/// h^2 / 2. The variance of a cone of radius R along an axis is 3/20 R^2 in 2D and 2/15 R^2 in 3D.
template <int Dim>
int passes_of(const Grid<Dim>& grid, double radius) {
  double square = 0.0;
  for (const double edge : grid.spacing()) square += edge * edge / Dim;
  const double cone = Dim == 2 ? 3.0 / 20.0 : 2.0 / 15.0;
  return static_cast<int>(std::lround(2.0 * cone * radius * radius / square));
}

}  // namespace

template <int Dim>
RepeatedAveraging<Dim>::RepeatedAveraging(const Part<Dim>& part, const DesignSupport<Dim>& support,
                                          double radius)
    : part_(part),
      support_(support),
      element_(part.grid().spacing(), part.grid().domain().thickness, 0.0),
      passes_(passes_of(part.grid(), radius)) {
  if (passes_ > 0) weight_ = to_nodes(std::vector<double>(part.elements().size(), 1.0));
}

template <int Dim>
std::vector<double> RepeatedAveraging<Dim>::to_elements(std::span<const double> of_nodes) const {
  return element_means<Dim>(part_, element_, part_.grid().exchange(1).ghosted(of_nodes)).mean;
}

template <int Dim>
std::vector<double> RepeatedAveraging<Dim>::to_nodes(std::span<const double> of_elements) const {
  const TimeDerivatives row{{of_elements.begin(), of_elements.end()}, {}};
  return pull_back_means<Dim>(part_, element_, {&row, 1}).values;
}

template <int Dim>
void RepeatedAveraging<Dim>::divide_by_weight(std::vector<double>& of_nodes) const {
  for (std::size_t node = 0; node < of_nodes.size(); ++node)
    if (weight_[node] > 0.0) of_nodes[node] /= weight_[node];
}

template <int Dim>
std::vector<double> RepeatedAveraging<Dim>::apply(std::span<const double> design) const {
  std::vector<double> variables(design.begin(), design.end());
  for (int pass = 0; pass < passes_; ++pass) {
    std::vector<double> field = support_.expand(variables);
    if (support_.on_nodes()) {
      field = to_nodes(to_elements(field));
      divide_by_weight(field);
    } else {
      field = to_nodes(part_.restrict_to_part(field));
      divide_by_weight(field);
      field = part_.expand(to_elements(field));
    }
    variables = support_.restrict_to_variables(field);
  }
  return variables;
}

// On elements, a pass is its own transpose.
template <int Dim>
std::vector<double> RepeatedAveraging<Dim>::apply_transpose(std::span<const double> design) const {
  if (!support_.on_nodes()) return apply(design);
  std::vector<double> variables(design.begin(), design.end());
  for (int pass = 0; pass < passes_; ++pass) {
    std::vector<double> field = support_.expand(variables);
    divide_by_weight(field);
    variables = support_.restrict_to_variables(to_nodes(to_elements(field)));
  }
  return variables;
}

FABSEQ_INSTANTIATE_CLASS(RepeatedAveraging);

}  // namespace fabseq
