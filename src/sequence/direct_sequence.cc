// SPDX-License-Identifier: MIT
#include "fabseq/sequence/direct_sequence.h"

#include "fabseq/fem/element_matrices.h"
#include "fabseq/sequence/element_means.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

namespace {

/// A pass has the kernel (1/4, 1/2, 1/4) along each axis, of variance h^2 / 2; the variance of a cone of
/// radius R along an axis is 3/20 R^2 in the plane, 2/15 R^2 in space.
template <int Dim>
int passes_of(const Grid<Dim>& grid, double radius) {
  double square = 0.0;
  for (const double edge : grid.spacing()) square += edge * edge / Dim;
  const double cone = Dim == 2 ? 3.0 / 20.0 : 2.0 / 15.0;
  return static_cast<int>(std::lround(2.0 * cone * radius * radius / square));
}

/// What both have in common.
template <int Dim>
class DirectSequence : public Sequence<Dim> {
 public:
  DirectSequence(const Part<Dim>& part, const DesignSupport<Dim>& support, const StartRegion& region,
                 double filter_radius)
      : part_(part), support_(support), region_(region), filter_(part, support, filter_radius) {}

  bool has_design() const override { return true; }
  std::size_t variables() const override { return support_.size(); }
  std::vector<double> initial_design() const override { return region_.initial_time; }

 protected:
  const Part<Dim>& part() const { return part_; }
  /// Filtered times on the owned elements or nodes.
  std::vector<double> times(std::span<const double> design) const {
    return support_.expand(filter_.apply(design));
  }
  /// Gradient by the design from that by the filtered times.
  std::vector<double> by_design(std::span<const double> by_times) const {
    return filter_.apply_transpose(support_.restrict_to_variables(by_times));
  }

 private:
  const Part<Dim>& part_;
  const DesignSupport<Dim>& support_;
  const StartRegion& region_;
  RepeatedAveraging<Dim> filter_;
};

template <int Dim>
class ElementSequence : public DirectSequence<Dim> {
 public:
  using DirectSequence<Dim>::DirectSequence;

  const PseudoTime<Dim>& update(std::span<const double> design) override {
    time_.time = this->part().restrict_to_part(this->times(design));
    return time_;
  }

  std::vector<std::vector<double>> pull_back(std::span<const TimeDerivatives> rows) override {
    std::vector<std::vector<double>> result;
    for (const TimeDerivatives& row : rows) result.push_back(this->by_design(this->part().expand(row.time)));
    return result;
  }

 private:
  PseudoTime<Dim> time_;
};

template <int Dim>
class NodeSequence : public DirectSequence<Dim> {
 public:
  NodeSequence(const Part<Dim>& part, const DesignSupport<Dim>& support, const StartRegion& region,
               double filter_radius)
      : DirectSequence<Dim>(part, support, region, filter_radius),
        element_(part.grid().spacing(), part.grid().domain().thickness, 0.0) {}

  const PseudoTime<Dim>& update(std::span<const double> design) override {
    const Grid<Dim>& grid = this->part().grid();
    std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()));
    grid.exchange(1).to_ghosted(this->times(design), ghosted);
    ElementMeans means = element_means<Dim>(this->part(), element_, ghosted);
    time_.time = std::move(means.mean);
    time_.gradient = std::move(means.gradient);
    return time_;
  }

  std::vector<std::vector<double>> pull_back(std::span<const TimeDerivatives> rows) override {
    std::vector<std::vector<double>> result;
    for (std::size_t first = 0; first < rows.size(); first += rows_at_once) {
      const LaneVector nodal = pull_back_means<Dim>(
          this->part(), element_, rows.subspan(first, std::min(rows_at_once, rows.size() - first)));
      for (int lane = 0; lane < nodal.lanes; ++lane) result.push_back(this->by_design(nodal.lane(lane)));
    }
    return result;
  }

 private:
  /// That share a message to the neighbours.
  static constexpr std::size_t rows_at_once = 8;

  ElementMatrices<Dim> element_;
  PseudoTime<Dim> time_;
};

}  // namespace

template <int Dim>
RepeatedAveraging<Dim>::RepeatedAveraging(const Part<Dim>& part, const DesignSupport<Dim>& support,
                                          double radius)
    : part_(part),
      support_(support),
      element_(part.grid().spacing(), part.grid().domain().thickness, 0.0),
      passes_(passes_of(part.grid(), radius)) {
  if (!is_identity()) weight_ = to_nodes(std::vector<double>(part.elements().size(), 1.0));
}

template <int Dim>
std::vector<double> RepeatedAveraging<Dim>::to_elements(std::span<const double> of_nodes) const {
  const Grid<Dim>& grid = part_.grid();
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()));
  grid.exchange(1).to_ghosted(of_nodes, ghosted);
  return element_means<Dim>(part_, element_, ghosted).mean;
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

// Of elements a pass is its own transpose.
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

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_direct_sequence(const Part<Dim>& part, const DesignSupport<Dim>& support,
                                                    const StartRegion& region, double filter_radius) {
  if (support.on_nodes()) return std::make_unique<NodeSequence<Dim>>(part, support, region, filter_radius);
  return std::make_unique<ElementSequence<Dim>>(part, support, region, filter_radius);
}

FABSEQ_INSTANTIATE_FUNCTION(make_direct_sequence);
FABSEQ_INSTANTIATE_CLASS(RepeatedAveraging);

}  // namespace fabseq
