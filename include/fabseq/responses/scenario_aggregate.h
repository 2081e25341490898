// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/responses/response.h"

#include <memory>

namespace fabseq {

/// What counts of a distortion J(u) where the strain is not known exactly (docs/formulation.md 5.1).
enum class Aggregate {
  nominal,  ///< J for the strain as given
  mean,     ///< mean of J(u_s) over the scenarios
  spread,   ///< mean of J(u_s - mean of all u_s)
  worst     ///< largest J(u_s)
};
constexpr const char* aggregate_names = "nominal mean spread worst";

/// A distortion of one component, aggregated over the scenarios of material.scenarios, of which there must be
/// some. `of_increments`: whether it depends on single layers' increments. Not collective. Source: fabseq's
/// own.
template <int Dim>
std::unique_ptr<Response<Dim>> aggregated(std::unique_ptr<Response<Dim>> distortion, Aggregate aggregate,
                                          bool of_increments);

}  // namespace fabseq
