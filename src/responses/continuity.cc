// SPDX-License-Identifier: MIT
/// Constraint: the pseudo-time has no bumps, so no layer begins in the air (docs/formulation.md 7).
#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"
#include "fabseq/responses/response_type.h"

#include <array>
#include <cstdint>
#include <vector>

namespace fabseq {

namespace {

/// Face neighbours of an element that are in the part, as offsets in the halo's box.
template <int Dim>
struct Neighbours {
  std::array<std::int64_t, 2 * Dim> offsets;
  int count = 0;
};

struct ContinuitySettings {
  double limit = 1e-3;
};

/// One component, at most `limit`: the mean over the part elements outside the start region of (t_e - mean t
/// of the face neighbours in the part)^2. For elements without neighbours the difference is 0. Construction
/// is collective on the grid's communicator.
template <int Dim>
class Continuity : public Response<Dim> {
 public:
  Continuity(const ResponseContext<Dim>& context, const ContinuitySettings& settings)
      : part_(context.part), limit_(settings.limit), halo_(context.part.grid(), 1) {
    const std::size_t elements = part_.elements().size();
    const std::vector<double> in_part = halo_.gather(part_.expand(std::vector<double>(elements, 1.0)));
    std::int64_t counted = 0;
    for (std::size_t e = 0; e < elements; ++e) {
      neighbours_.push_back(
          find_neighbours(part_.grid().owned_elements().index(part_.elements()[e]), in_part));
      if (!context.start.empty() && context.start[e] != 0) neighbours_.back().count = 0;
      counted += context.start.empty() || context.start[e] == 0 ? 1 : 0;
    }
    elements_counted_ = static_cast<double>(sum(part_.grid().comm(), counted));
  }

  std::vector<double> values(const StageResults<Dim>& state) const override {
    double total = 0.0;
    for (const double difference : differences(state)) total += difference * difference;
    return {sum(part_.grid().comm(), total) / elements_counted_};
  }

  void add_derivative(int, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const std::vector<double> differences = this->differences(state);
    std::vector<double> of_box(static_cast<std::size_t>(halo_.box().count()), 0.0);
    for (std::size_t e = 0; e < differences.size(); ++e) {
      const double derivative = 2.0 * weight / elements_counted_ * differences[e];
      of_box[halo_.box().offset(part_.grid().owned_elements().index(part_.elements()[e]))] += derivative;
      const Neighbours<Dim>& around = neighbours_[e];
      for (int n = 0; n < around.count; ++n) of_box[around.offsets[n]] -= derivative / around.count;
    }
    const std::vector<double> d_time = part_.restrict_to_part(halo_.scatter_add(of_box));
    auto& result = DensityDerivatives::zeros_if_empty(adjoint.time.time, d_time.size());
    for (std::size_t e = 0; e < d_time.size(); ++e) result[e] += d_time[e];
  }

  std::vector<ConstraintRow> rows(double margin) const override { return {{1.0, margin * limit_, limit_}}; }

 private:
  Neighbours<Dim> find_neighbours(const Index<Dim>& element, const std::vector<double>& in_part) const {
    Neighbours<Dim> result{};
    for (int face = 0; face < 2 * Dim; ++face) {
      Index<Dim> other = element;
      other[face / 2] += face % 2 == 0 ? -1 : 1;
      if (!halo_.box().contains(other)) continue;
      const std::int64_t offset = halo_.box().offset(other);
      if (in_part[offset] > 0.0) result.offsets[result.count++] = offset;
    }
    return result;
  }

  /// Part field t_e - mean t of the neighbours; 0 for elements that do not count. Collective.
  std::vector<double> differences(const StageResults<Dim>& state) const {
    const std::vector<double> time = halo_.gather(part_.expand(state.time->time));
    std::vector<double> result(neighbours_.size(), 0.0);
    for (std::size_t e = 0; e < result.size(); ++e) {
      const Neighbours<Dim>& around = neighbours_[e];
      if (around.count == 0) continue;
      double total = 0.0;
      for (int n = 0; n < around.count; ++n) total += time[around.offsets[n]];
      result[e] = state.time->time[e] - total / around.count;
    }
    return result;
  }

  const Part<Dim>& part_;
  double limit_;
  ElementHalo<Dim> halo_;
  std::vector<Neighbours<Dim>> neighbours_;  ///< [part element]; count is 0 in the start region
  double elements_counted_ = 0.0;            ///< summed over all ranks
};

const Registered<Continuity, ContinuitySettings> registered(
    {.list = TermList::constraints, .name = "continuity"},
    Section<ContinuitySettings>("constraints")
        .key("limit", &ContinuitySettings::limit,
             "Largest mean square of the difference from the neighbours' mean", {.range = "(0, inf)"}));

}  // namespace

}  // namespace fabseq
