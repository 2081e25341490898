// SPDX-License-Identifier: MIT
/// \file
/// Plastic flow at a point: radial return, eight elements at a time (docs/formulation.md 16).
#pragma once

#include "process/element_modes.h"

#include <array>

namespace fabseq {

/// Elements side by side.
inline constexpr int plastic_width = 8;
using PlasticLanes = Lanes<plastic_width>;
/// Six components of a symmetric tensor, Voigt.
using Voigt = std::array<PlasticLanes, ElementModes::strains>;
using Amplitudes = std::array<PlasticLanes, ElementModes::amplitudes>;
using ModeLanes = ElementModes::Modes<plastic_width>;

/// Stiffness of an isotropic material with unit Young's modulus.
struct IsotropicStiffness {
  double lame, shear;

  explicit IsotropicStiffness(double poisson)
      : lame(poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))), shear(0.5 / (1.0 + poisson)) {}
  Voigt stress(const Voigt& strain) const {
    Voigt result;
    const PlasticLanes mean = (strain[0] + strain[1] + strain[2]) * lame;
    for (int a = 0; a < 3; ++a) {
      result[a] = mean + strain[a] * (2.0 * shear);
      result[3 + a] = strain[3 + a] * shear;
    }
    return result;
  }
};

/// Stress less its mean.
inline Voigt deviator(const Voigt& stress) {
  Voigt result = stress;
  const PlasticLanes mean = (stress[0] + stress[1] + stress[2]) * (1.0 / 3.0);
  for (int a = 0; a < 3; ++a) result[a] = stress[a] - mean;
  return result;
}

/// sqrt(3/2 d:d), where shear counts twice.
inline PlasticLanes equivalent(const Voigt& d) {
  PlasticLanes square = PlasticLanes::zero();
  for (int a = 0; a < 3; ++a) square += d[a] * d[a] * 1.5 + d[3 + a] * d[3 + a] * 3.0;
  return root(square);
}

/// Sum of the products of components.
template <std::size_t Size>
PlasticLanes paired(const std::array<PlasticLanes, Size>& a, const std::array<PlasticLanes, Size>& b) {
  PlasticLanes result = PlasticLanes::zero();
  for (std::size_t c = 0; c < Size; ++c) result += a[c] * b[c];
  return result;
}

/// Material of an element in a step, for unit Young's modulus at room temperature.
struct PlasticStep {
  PlasticLanes modulus;    ///< f
  PlasticLanes stiffness;  ///< a
  PlasticLanes yield, hardening;
  PlasticLanes elongation;  ///< g
  PlasticLanes load;        ///< (drho)^q
  Voigt inherent_strain;    ///< of new material
};

/// State of an element on its way through the steps.
struct PlasticPoint {
  Voigt stress;
  PlasticLanes plastic_strain;
  Amplitudes hourglass;  ///< h, as amplitudes of the displacement
  // Of the step before.
  PlasticLanes modulus, stiffness, elongation;
};

/// What a step has done to a point, as its adjoint needs it.
struct PlasticReturn {
  PlasticLanes ratio;            ///< phi
  PlasticLanes young;            ///< E
  Voigt load;                    ///< l over f: its strain
  Voigt direction;               ///< n = d/q
  PlasticLanes share;            ///< r
  PlasticLanes flow;             ///< Delta gamma; 0: elastic
  PlasticLanes stress_of_shear;  ///< 3 G
};

/// Takes a point through a step. `displacement`: of the step. Unless the process is `Heated`, modulus and
/// elongation stay as they are.
template <bool Heated>
[[gnu::always_inline]] inline PlasticReturn advance(const IsotropicStiffness& elastic,
                                                    const PlasticStep& step, const ModeLanes& displacement,
                                                    PlasticPoint& point) {
  constexpr int strains = ElementModes::strains;
  PlasticReturn result;
  result.ratio = PlasticLanes::broadcast(1.0);
  result.young = step.stiffness;
  for (int c = 0; c < strains; ++c) result.load[c] = step.load * step.inherent_strain[c];
  Voigt trial;
  if constexpr (Heated) {
    result.ratio = step.modulus / point.modulus;  // of nothing before the first step
    result.young = step.modulus * step.stiffness;
    const PlasticLanes growth = point.stiffness * (step.elongation - point.elongation);
    for (int a = 0; a < 3; ++a) result.load[a] += growth;
    for (int c = 0; c < strains; ++c)
      trial[c] = result.young * displacement[c] - step.modulus * result.load[c];
    trial = elastic.stress(trial);
    for (int c = 0; c < strains; ++c) trial[c] += result.ratio * point.stress[c];
  } else {
    for (int c = 0; c < strains; ++c) trial[c] = result.young * displacement[c] - result.load[c];
    trial = elastic.stress(trial);
    for (int c = 0; c < strains; ++c) trial[c] += point.stress[c];
  }
  const Voigt d = deviator(trial);
  const PlasticLanes q = equivalent(d),
                     inverse = PlasticLanes::broadcast(1.0) / larger(q, PlasticLanes::broadcast(1e-300));
  result.stress_of_shear = result.young * (3.0 * elastic.shear);
  result.flow = larger(PlasticLanes::zero(), (q - step.yield - step.hardening * point.plastic_strain) /
                                                 (result.stress_of_shear + step.hardening));
  result.share = result.stress_of_shear * result.flow * inverse;
  for (int c = 0; c < strains; ++c) {
    result.direction[c] = d[c] * inverse;
    point.stress[c] = trial[c] - result.share * d[c];
  }
  point.plastic_strain += result.flow;
  for (int k = 0; k < ElementModes::amplitudes; ++k)
    point.hourglass[k] = (Heated ? result.ratio * point.hourglass[k] : point.hourglass[k]) +
                         result.young * displacement[strains + k];
  point.stiffness = step.stiffness;
  if constexpr (Heated) {
    point.modulus = step.modulus;
    point.elongation = step.elongation;
  }
  return result;
}

}  // namespace fabseq
