// SPDX-License-Identifier: MIT
#include "sequence/direct_sequence.h"

#include "fabseq/fem/element_matrices.h"
#include "fabseq/sequence/element_means.h"
#include "sequence/repeated_averaging.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

template <int Dim>
class DirectSequence : public Sequence<Dim> {
 public:
  DirectSequence(const Part<Dim>& part, const DesignSupport<Dim>& support, const StartRegion& region,
                 double filter_radius)
      : part_(part),
        support_(support),
        region_(region),
        filter_(part, support, filter_radius),
        element_(part.grid().spacing(), part.grid().domain().thickness, 0.0) {}

  bool has_design() const override { return true; }
  std::size_t variables() const override { return support_.size(); }
  std::vector<double> initial_design() const override { return region_.initial_time; }

  const PseudoTime<Dim>& update(std::span<const double> design) override {
    std::vector<double> times = support_.expand(filter_.apply(design));
    if (support_.on_nodes()) {
      ElementMeans means = element_means<Dim>(part_, element_, part_.grid().exchange(1).ghosted(times));
      time_.time = std::move(means.mean);
      time_.gradient = std::move(means.gradient);
      time_.nodal = std::move(times);
    } else {
      time_.time = part_.restrict_to_part(times);
    }
    return time_;
  }

  std::vector<std::vector<double>> pull_back(std::span<const TimeDerivatives> rows) override {
    std::vector<std::vector<double>> result;
    const auto add = [this, &result](std::span<const double> by_times) {
      result.push_back(filter_.apply_transpose(support_.restrict_to_variables(by_times)));
    };
    for (std::size_t first = 0; first < rows.size(); first += rows_at_once) {
      const auto some = rows.subspan(first, std::min(rows_at_once, rows.size() - first));
      if (support_.on_nodes()) {
        const LaneVector nodal = pull_back_means<Dim>(part_, element_, some);
        for (int lane = 0; lane < nodal.lanes; ++lane) add(nodal.lane(lane));
      } else {
        for (const TimeDerivatives& row : some) add(part_.expand(row.time));
      }
    }
    return result;
  }

 private:
  /// Rows that share one exchange with the neighbours.
  static constexpr std::size_t rows_at_once = 8;

  const Part<Dim>& part_;
  const DesignSupport<Dim>& support_;
  const StartRegion& region_;
  RepeatedAveraging<Dim> filter_;
  ElementMatrices<Dim> element_;
  PseudoTime<Dim> time_;
};

}  // namespace

template <int Dim>
std::unique_ptr<Sequence<Dim>> make_direct_sequence(const Part<Dim>& part, const DesignSupport<Dim>& support,
                                                    const StartRegion& region, double filter_radius) {
  return std::make_unique<DirectSequence<Dim>>(part, support, region, filter_radius);
}

FABSEQ_INSTANTIATE_FUNCTION(make_direct_sequence);

}  // namespace fabseq
