// SPDX-License-Identifier: MIT
#include "process/plastic_point.h"

namespace fabseq {

PlasticReturn advance(const ElementMatrices<3>& element, double poisson, const PlasticStep& step,
                      const double* displacement, PlasticPoint& point) {
  constexpr int strains = ElementModes::strains;
  PlasticReturn result;
  result.ratio = step.modulus / point.modulus;  // of nothing before the first step
  result.young = step.modulus * step.stiffness;
  for (int c = 0; c < strains; ++c) result.load[c] = step.load * step.inherent_strain[c];
  for (int a = 0; a < 3; ++a) result.load[a] += point.stiffness * (step.elongation - point.elongation);
  Voigt strain;
  for (int c = 0; c < strains; ++c)
    strain[c] = result.young * displacement[c] - step.modulus * result.load[c];
  const Voigt elastic = element.stress(strain);
  Voigt trial;
  for (int c = 0; c < strains; ++c) trial[c] = result.ratio * point.stress[c] + elastic[c];
  const Voigt d = deviator(trial);
  const double q = equivalent(d);
  result.stress_of_shear = 3.0 * result.young / (2.0 * (1.0 + poisson));
  result.flow = std::max(0.0, (q - step.yield - step.hardening * point.plastic_strain) /
                                  (result.stress_of_shear + step.hardening));
  if (result.flow > 0.0) {
    result.share = result.stress_of_shear * result.flow / q;
    for (int c = 0; c < strains; ++c) result.direction[c] = d[c] / q;
  }
  for (int c = 0; c < strains; ++c) point.stress[c] = trial[c] - result.share * d[c];
  point.plastic_strain += result.flow;
  for (int k = 0; k < ElementModes::amplitudes; ++k)
    point.hourglass[k] = result.ratio * point.hourglass[k] + result.young * displacement[strains + k];
  point.modulus = step.modulus;
  point.stiffness = step.stiffness;
  point.elongation = step.elongation;
  return result;
}

}  // namespace fabseq
