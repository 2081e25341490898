// SPDX-License-Identifier: MIT
/// Constraint: no sub-part has more than its share of the part (docs/formulation.md 7).
#include "fabseq/base/mpi.h"
#include "fabseq/responses/response_type.h"

#include <limits>

namespace fabseq {

namespace {

struct SubpartVolumeSettings {
  double tolerance = 0.01;
};

/// One component per sub-part, V_i / (V* / N_P) - 1, at most `tolerance`. NaN without sub-parts.
template <int Dim>
class SubpartVolume : public Response<Dim> {
 public:
  SubpartVolume(const ResponseContext<Dim>& context, const SubpartVolumeSettings& settings)
      : comm_(context.part.grid().comm()),
        undefined_(context.sub_parts, std::numeric_limits<double>::quiet_NaN()),
        volume_fraction_(context.part.grid().element_volume() / context.part.volume()),
        tolerance_(settings.tolerance) {}

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const SubParts& sub_parts = state.densities->sub_parts;
    if (sub_parts.count() == 0) return undefined_;  // the planar baseline
    std::vector<double> result;
    for (const auto& densities : sub_parts.density) {
      double total = 0.0;
      for (const double density : densities) total += density;
      result.push_back(share_of_element(sub_parts) * total);
    }
    sum_in_place(comm_, result);
    for (double& value : result) value -= 1.0;
    return result;
  }

  void add_derivative(int component, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const SubParts& sub_parts = state.densities->sub_parts;
    for (double& derivative : adjoint.densities.sub_part_or_zeros(sub_parts, component))
      derivative += weight * share_of_element(sub_parts);
  }

  std::vector<ConstraintRow> rows(double margin) const override { return {{1.0, margin * tolerance_}}; }

 private:
  /// Volume of a full element relative to a sub-part's equal share.
  double share_of_element(const SubParts& sub_parts) const { return volume_fraction_ * sub_parts.count(); }

  MPI_Comm comm_;
  std::vector<double> undefined_;
  double volume_fraction_, tolerance_;
};

const Registered<SubpartVolume, SubpartVolumeSettings> registered(
    {.list = TermList::constraints, .name = "subpart_volume", .layers = LayerKind::multi_planar},
    Section<SubpartVolumeSettings>("constraints")
        .key("tolerance", &SubpartVolumeSettings::tolerance,
             "How far a sub-part may exceed its equal share, relative to it", {.range = "[0, 1)"}));

}  // namespace

}  // namespace fabseq
