// SPDX-License-Identifier: MIT
#include "process/plastic_history.h"

#include <algorithm>

namespace fabseq {

namespace {

constexpr int strain_count = ElementModes::strains;
constexpr int mode_count = ElementModes::components;
constexpr int step_size = mode_count * plastic_width;

// Number by number: copies of all of them at once are calls of the library.

ModeLanes loaded(const double* values) {
  ModeLanes result;
  for (int c = 0; c < mode_count; ++c) result[c] = PlasticLanes::load(values + c * plastic_width);
  return result;
}

ModeLanes difference(const double* values, const double* less) {
  ModeLanes result;
  for (int c = 0; c < mode_count; ++c)
    result[c] = PlasticLanes::load(values + c * plastic_width) - PlasticLanes::load(less + c * plastic_width);
  return result;
}

void store(const ModeLanes& modes, double* to) {
  for (int c = 0; c < mode_count; ++c) modes[c].store(to + c * plastic_width);
}

void store_forces(const PlasticPoint& point, double* to) {
  for (int c = 0; c < strain_count; ++c) point.stress[c].store(to + c * plastic_width);
  for (int k = 0; k < ElementModes::amplitudes; ++k)
    point.hourglass[k].store(to + (strain_count + k) * plastic_width);
}

/// Turns stored forces into what they have grown by since then.
void store_growth(const PlasticPoint& point, double* forces) {
  const auto grow = [forces](int c, const PlasticLanes& now) {
    double* place = forces + c * plastic_width;
    (now - PlasticLanes::load(place)).store(place);
  };
  for (int c = 0; c < strain_count; ++c) grow(c, point.stress[c]);
  for (int k = 0; k < ElementModes::amplitudes; ++k) grow(strain_count + k, point.hourglass[k]);
}

}  // namespace

PlasticDual PlasticDual::zero() {
  PlasticDual result;
  result.stress.fill(PlasticLanes::zero());
  result.hourglass.fill(PlasticLanes::zero());
  result.plastic_strain = result.modulus = result.elongation = PlasticLanes::zero();
  return result;
}

ModeLanes PlasticHistory::increment(const PlasticWave& wave, int step, const double* displacements) const {
  const double* own = displacements + step * step_size;
  const bool is_sum = accumulated_ && !wave.release && step > 0;
  return is_sum ? difference(own, own - step_size) : loaded(own);
}

void PlasticHistory::run(const PlasticWave& wave, std::size_t batch, const double* displacements,
                         double* forces, PlasticPoint& point) const {
  if (accumulated_)
    go_through<true>(wave, batch, displacements, forces, point);
  else
    go_through<false>(wave, batch, displacements, forces, point);
}

template <bool Heated>
void PlasticHistory::go_through(const PlasticWave& wave, std::size_t batch, const double* displacements,
                                double* forces, PlasticPoint& point) const {
  const bool sums = accumulated_ || wave.release;
  for (int s = 0; s < wave.count; ++s) {
    double* own = forces != nullptr ? forces + s * step_size : nullptr;
    if (own != nullptr && !sums) store_forces(point, own);
    advance<Heated>(elastic_, material_.step(batch, s), increment(wave, s, displacements), point);
    if (own == nullptr) continue;
    if (sums)
      store_forces(point, own);
    else
      store_growth(point, own);
  }
}

/// Adjoint displacement of a step less that of the next one.
ModeLanes PlasticHistory::adjoint_difference(const PlasticWave& wave, int step, const double* adjoint) const {
  const double* own = adjoint + step * step_size;
  const bool is_difference = accumulated_ || step + 1 == wave.count;
  return is_difference ? loaded(own) : difference(own, own + step_size);
}

/// Sets the adjoint of a step, and takes `dual` from behind the step to before it.
void PlasticHistory::step_back(Record& own, const ModeLanes& difference, PlasticDual& dual) const {
  Voigt& mu = dual.stress;
  for (int c = 0; c < strain_count; ++c) mu[c] += difference[c];
  for (int k = 0; k < ElementModes::amplitudes; ++k)
    own.hourglass[k] = difference[strain_count + k] + dual.hourglass[k];
  const Voigt &n = own.returned.direction, d = deviator(mu);
  const PlasticLanes r = own.returned.share, shear = own.returned.stress_of_shear,
                     flows = is_positive(own.returned.flow);
  own.a = paired(mu, n) * flows;
  own.c = (dual.plastic_strain - shear * own.a) / (shear + own.step.hardening) * flows;
  const PlasticLanes along = (r * own.a + own.c) * 1.5;
  for (int c = 0; c < strain_count; ++c) own.dual[c] = mu[c] - r * d[c] + along * n[c] * (c < 3 ? 1.0 : 2.0);
  dual.plastic_strain = dual.plastic_strain - own.step.hardening * own.c;
  own.ratio = paired(own.dual, own.before.stress) * modes_.volume() +
              modes_.energy<plastic_width>(own.hourglass, own.before.hourglass);
  for (int c = 0; c < strain_count; ++c) mu[c] = own.returned.ratio * own.dual[c];
  for (int k = 0; k < ElementModes::amplitudes; ++k)
    dual.hourglass[k] = own.returned.ratio * own.hourglass[k];
}

/// `behind`: what is behind the step.
PlasticStepDerivatives PlasticHistory::derivatives(const Record& own, const PlasticDual& behind) const {
  PlasticStepDerivatives result;
  const double volume = modes_.volume();
  Voigt strain, load = elastic_.stress(own.dual);  // -dJ/dl
  std::copy_n(own.displacement.begin(), strain_count, strain.begin());
  Amplitudes amplitudes;
  std::copy_n(own.displacement.begin() + strain_count, amplitudes.size(), amplitudes.begin());
  PlasticLanes young =
      paired(load, strain) * volume + modes_.energy<plastic_width>(own.hourglass, amplitudes);
  young = young - own.returned.flow * (own.a + own.c) * (3.0 * volume * elastic_.shear);
  for (PlasticLanes& value : load) value = value * -volume;
  result.yield = own.c * -volume;
  result.hardening = result.yield * own.plastic_strain;
  result.stiffness = own.step.modulus * young;
  result.modulus = own.step.stiffness * young + paired(load, own.returned.load) +
                   own.ratio / own.before.modulus - behind.modulus / own.step.modulus;
  const PlasticLanes normal = load[0] + load[1] + load[2];
  result.elongation =
      own.step.modulus * own.before.stiffness * normal - own.step.stiffness * behind.elongation;
  result.stiffness_before = own.step.modulus * (own.step.elongation - own.before.elongation) * normal;
  result.load = own.step.modulus * paired(load, own.step.inherent_strain);
  for (int c = 0; c < strain_count; ++c)
    result.inherent_strain[c] = own.step.modulus * own.step.load * load[c];
  return result;
}

void PlasticHistory::run_back(const PlasticWave& wave, std::size_t batch, const double* displacements,
                              const double* adjoint, PlasticPoint point, double* forces, PlasticDual& dual,
                              const ProcessDerivatives* to, Records& records) const {
  records.resize(static_cast<std::size_t>(wave.count));
  for (int s = 0; s < wave.count; ++s) {
    Record& own = records[s];
    own.before = point;
    own.step = material_.step(batch, s);
    own.displacement = increment(wave, s, displacements);
    own.returned = advance<true>(elastic_, own.step, own.displacement, point);
    own.plastic_strain = point.plastic_strain;
  }
  for (int s = wave.count; s-- > 0;) {
    Record& own = records[s];
    const PlasticDual behind_step = dual;
    step_back(own, adjoint_difference(wave, s, adjoint), dual);
    const Voigt stress = elastic_.stress(own.dual);
    ModeLanes force;
    for (int c = 0; c < strain_count; ++c) force[c] = own.returned.young * stress[c];
    for (int k = 0; k < ElementModes::amplitudes; ++k)
      force[strain_count + k] = own.returned.young * own.hourglass[k];
    if (forces != nullptr) store(force, forces + s * step_size);
    dual.modulus = own.returned.ratio * own.ratio;
    dual.elongation = own.step.modulus * (stress[0] + stress[1] + stress[2]) * -modes_.volume();
    if (to != nullptr) material_.add_derivatives(batch, s, derivatives(own, behind_step), *to);
  }
}

}  // namespace fabseq
