// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "process/element_modes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fabseq {

/// Six components of a symmetric tensor, Voigt.
using Voigt = std::array<double, ElementModes::strains>;

/// Interpolation of the yield stress of an element with this density, and its slope; its least value keeps
/// void from yielding (docs/formulation.md 16).
struct YieldShare {
  static constexpr double least = 1e-4, exponent = 2.5;

  static double of(double density) {
    return least + (1.0 - least) * std::pow(std::max(density, 0.0), exponent);
  }
  static double slope(double density) {
    return (1.0 - least) * exponent * std::pow(std::max(density, 0.0), exponent - 1.0);
  }
};

/// Stress less its mean.
inline Voigt deviator(const Voigt& stress) {
  Voigt result = stress;
  const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
  for (int a = 0; a < 3; ++a) result[a] -= mean;
  return result;
}

/// sqrt(3/2 d:d), where shear counts twice.
inline double equivalent(const Voigt& d) {
  double square = 0.0;
  for (int a = 0; a < 3; ++a) square += 1.5 * d[a] * d[a] + 3.0 * d[3 + a] * d[3 + a];
  return std::sqrt(square);
}

/// Sum of the products of components.
inline double paired(const Voigt& a, const Voigt& b) {
  double result = 0.0;
  for (int c = 0; c < ElementModes::strains; ++c) result += a[c] * b[c];
  return result;
}

/// Material of an element in a step, for unit Young's modulus at room temperature.
struct PlasticStep {
  double modulus = 1.0;    ///< f
  double stiffness = 1.0;  ///< a
  double yield = 0.0, hardening = 0.0;
  double elongation = 0.0;  ///< g
  double load = 0.0;        ///< (drho)^q
  Voigt inherent_strain{};  ///< of new material
};

/// State of an element on its way through the steps (docs/formulation.md 16).
struct PlasticPoint {
  Voigt stress{};
  double plastic_strain = 0.0;
  std::array<double, ElementModes::amplitudes> hourglass{};  ///< h, as amplitudes of the displacement
  // Of the step before.
  double modulus = 1.0, stiffness = 0.0, elongation = 0.0;
};

/// What a step has done to a point, as its adjoint needs it.
struct PlasticReturn {
  double ratio = 1.0;            ///< phi
  double young = 0.0;            ///< E
  Voigt load{};                  ///< l over f: its strain
  Voigt direction{};             ///< n = d/q
  double share = 0.0;            ///< r
  double flow = 0.0;             ///< Delta gamma; 0: elastic
  double stress_of_shear = 0.0;  ///< 3 G
};

/// Takes a point through a step: radial return. `displacement`: of the step, as ElementModes.
PlasticReturn advance(const ElementMatrices<3>& element, double poisson, const PlasticStep& step,
                      const double* displacement, PlasticPoint& point);

}  // namespace fabseq
