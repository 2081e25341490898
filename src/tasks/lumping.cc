// SPDX-License-Identifier: MIT
#include "tasks/lumping.h"

#include "fabseq/base/error.h"
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "tasks/advice.h"

#include <array>
#include <cmath>
#include <exception>
#include <string>

namespace fabseq {

namespace {

DistortionLengths lengths_of(const VariedNumbers& numbers) {
  DistortionLengths result{std::nullopt, numbers.rms};
  if (!numbers.distortions.empty() && numbers.distortions.front())
    result.term = std::sqrt(*numbers.distortions.front());
  return result;
}

template <int Dim>
Lumping simulated_lumping(const Setup<Dim>& setup, const GivenDesign<Dim>& given, PhaseTimer& timer) {
  const double per_bead = elements_per_bead(setup);
  const std::array<Variation, 2> variations = variations_of_passes(setup, per_bead);
  const int finer = variations[0].finer ? 2 : 1;
  Lumping result;
  result.per_bead = finer * per_bead;
  for (const int elements : setup.grid.domain().elements) result.elements.push_back(finer * elements);
  print(std::string("simulates real layers") + (finer > 1 ? " on a grid twice as fine" : "") +
        ", for comparison");
  const VariedPair simulated = simulate_varied(setup, given, variations[0], false, timer);
  stop_if_requested(setup.world());
  const VariedPair real = simulate_varied(setup, given, variations[1], false, timer);
  result.simulated = lengths_of(simulated.sequence.own);
  result.planar_simulated = lengths_of(simulated.planar.own);
  result.real = lengths_of(real.sequence.own);
  result.planar_real = lengths_of(real.planar.own);
  return result;
}

}  // namespace

template <int Dim>
std::optional<Lumping> simulate_lumping(const Setup<Dim>& setup, const GivenDesign<Dim>& given,
                                        PhaseTimer& timer) {
  const auto left_out = [](const std::exception& reason) {
    warn(std::string("real layers are not simulated: ") + reason.what());
    return std::nullopt;
  };
  try {
    return simulated_lumping(setup, given, timer);
  } catch (const InputError& reason) {
    return left_out(reason);
  } catch (const NumericalError& reason) {
    return left_out(reason);
  } catch (const Stopped& reason) {
    return left_out(reason);
  }
}

FABSEQ_INSTANTIATE_FUNCTION(simulate_lumping);

}  // namespace fabseq
