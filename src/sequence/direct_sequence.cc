// SPDX-License-Identifier: MIT
#include "fabseq/sequence/direct_sequence.h"

#include "fabseq/fem/element_matrices.h"
#include "fabseq/sequence/element_means.h"
#include "fabseq/sequence/repeated_averaging.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

/// Common base of the direct sequences on elements and on nodes.
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
  /// Filtered times on the owned elements or nodes. Collective.
  std::vector<double> times(std::span<const double> design) const {
    return support_.expand(filter_.apply(design));
  }
  /// Gradient with respect to the design from that with respect to the filtered times. Collective.
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
  /// Rows that share one exchange with the neighbours.
  static constexpr std::size_t rows_at_once = 8;

  ElementMatrices<Dim> element_;
  PseudoTime<Dim> time_;
};

}  // namespace

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_direct_sequence(const Part<Dim>& part, const DesignSupport<Dim>& support,
                                                    const StartRegion& region, double filter_radius) {
  if (support.on_nodes()) return std::make_unique<NodeSequence<Dim>>(part, support, region, filter_radius);
  return std::make_unique<ElementSequence<Dim>>(part, support, region, filter_radius);
}

FABSEQ_INSTANTIATE_FUNCTION(make_direct_sequence);

}  // namespace fabseq
