// SPDX-License-Identifier: MIT
#include "sequence/guided_start.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/refusal.h"
#include "fabseq/sequence/element_means.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "sequence/start_domain.h"
#include "sequence/tilt_vectors.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

template <int Dim>
using Tilt = std::array<double, Dim - 1>;

/// The tilt vector of settings that name a direction.
template <int Dim>
Tilt<Dim> tilt_of_settings(const BuildPlate& plate, const GuidedSettings& settings) {
  Point<Dim> direction;
  std::copy_n(settings.direction.begin(), Dim, direction.begin());
  return TiltVectors<Dim>(plate).tilt_of(direction);
}

/// The tilt vectors of the gradient of the distance from the plate, none longer than the bound.
template <int Dim>
std::vector<Tilt<Dim>> tilts_of_distance(const Part<Dim>& part, double bound,
                                         const ElementMatrices<Dim>& element) {
  const std::vector<double> distance = geodesic_distance_of_nodes<Dim>(part, start_domain(part).fixed);
  const std::vector<double> gradient =
      element_means<Dim>(part, element, part.grid().exchange(1).ghosted(distance)).gradient;
  const TiltVectors<Dim> tilts(part.plate());
  std::vector<Tilt<Dim>> result(part.elements().size());
  for (std::size_t e = 0; e < result.size(); ++e) {
    Point<Dim> direction;
    std::copy_n(&gradient[e * Dim], Dim, direction.begin());
    result[e] = tilts.tilt_of(direction);
    const double angle = std::sqrt(dot(result[e], result[e]));
    if (angle > bound)
      for (double& component : result[e]) component *= bound / angle;
  }
  return result;
}

}  // namespace

template <int Dim>
std::vector<double> guided_start(const Part<Dim>& part, const GuidedSettings& settings,
                                 const ElementMatrices<Dim>& element) {
  std::vector<Tilt<Dim>> tilts;
  if (settings.start == GuidedStart::distance) {
    tilts = tilts_of_distance(part, settings.tilt_bound(), element);
  } else {
    const bool tilted = settings.start == GuidedStart::direction;
    tilts.assign(part.elements().size(),
                 tilted ? tilt_of_settings<Dim>(part.plate(), settings) : Tilt<Dim>{});
  }
  const DesignSpace space = settings.space(Dim);
  std::vector<double> result;
  for (const Tilt<Dim>& tilt : tilts) {
    for (int c = 0; c < Dim - 1; ++c)
      result.push_back(std::clamp(tilt[c], space.of(c).lower, space.of(c).upper));
    if (settings.stretch) result.push_back(std::clamp(0.0, space.of(Dim - 1).lower, space.of(Dim - 1).upper));
  }
  return result;
}

template <int Dim>
void require_start_within_tilt(const BuildPlate& plate, const GuidedSettings& settings) {
  if (settings.start != GuidedStart::direction) return;
  constexpr double rounding = 1e-9;
  const Tilt<Dim> tilt = tilt_of_settings<Dim>(plate, settings);
  const bool flipped =
      dot(tilt, tilt) == 0.0 && settings.direction[plate.axis] * (plate.upper ? -1.0 : 1.0) < 0.0;
  const bool within = std::all_of(tilt.begin(), tilt.end(), [&](double component) {
    return std::abs(component) <= settings.tilt_bound() * (1.0 + rounding);
  });
  if (within && !flipped) return;
  refuse("/sequence/initial", shown(settings.direction),
         formatted("a direction that the plate's normal leans to by at most %g degrees along each axis",
                   settings.max_tilt));
}

FABSEQ_INSTANTIATE_FUNCTION(guided_start);
FABSEQ_INSTANTIATE_FUNCTION(require_start_within_tilt);

}  // namespace fabseq
