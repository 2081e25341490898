// SPDX-License-Identifier: MIT
#pragma once

#include "process/element_modes.h"
#include "process/plastic_material.h"
#include "process/plastic_point.h"
#include "process/plastic_wave.h"

#include <cstddef>
#include <vector>

namespace fabseq {

/// What stands behind a step, backwards (docs/developer/derivatives.md 16).
struct PlasticDual {
  Voigt stress;                 ///< mu
  PlasticLanes plastic_strain;  ///< mu_kappa
  Amplitudes hourglass;         ///< phi eta
  PlasticLanes modulus;         ///< phi dJ/dphi
  PlasticLanes elongation;      ///< f m . l^

  static PlasticDual zero();
};

/// Histories of plastic flow in batches of elements (docs/formulation.md 16), J2 with isotropic hardening and
/// one state per element, and back: of the steps of a wave. Stresses are for unit Young's modulus at room
/// temperature. Values of histories are [step][ElementModes][element]. Local.
class PlasticHistory {
 public:
  /// All arguments must outlive the object. `accumulated`, where there are temperatures: displacements are
  /// sums from the wave's first step on; forces are sums from the first step of all, then, else what each
  /// step adds.
  PlasticHistory(const ElasticModel<3>& model, const ElementModes& modes, const PlasticMaterial& material,
                 bool accumulated)
      : elastic_(model.material.poisson), modes_(modes), material_(material), accumulated_(accumulated) {}

  /// Takes the states of a batch through the steps. Sets `forces`, unless it is null, to stresses and
  /// amplitudes times stiffness (ElementModes::forces()); those of the release are sums.
  void run(const PlasticWave& wave, std::size_t batch, const double* displacements, double* forces,
           PlasticPoint& point) const;

  /// A step forward, and of its adjoint.
  struct Record;
  using Records = std::vector<Record>;
  /// Takes adjoints of a batch back through the steps. `point`: the state before them. `adjoint`: lambda_s
  /// less that of the step behind the wave, or where displacements are sums, less lambda_{s+1}. Sets
  /// `forces`, unless it is null, to the equation of each step. Adds derivatives to `to`, unless it is null.
  /// Uses `records`.
  void run_back(const PlasticWave& wave, std::size_t batch, const double* displacements,
                const double* adjoint, PlasticPoint point, double* forces, PlasticDual& dual,
                const ProcessDerivatives* to, Records& records) const;

 private:
  template <bool Heated>
  void go_through(const PlasticWave& wave, std::size_t batch, const double* displacements, double* forces,
                  PlasticPoint& point) const;
  ModeLanes increment(const PlasticWave& wave, int step, const double* displacements) const;
  ModeLanes adjoint_difference(const PlasticWave& wave, int step, const double* adjoint) const;
  void step_back(Record& own, const ModeLanes& difference, PlasticDual& dual) const;
  PlasticStepDerivatives derivatives(const Record& own, const PlasticDual& behind) const;

  IsotropicStiffness elastic_;
  const ElementModes& modes_;
  const PlasticMaterial& material_;
  bool accumulated_;
};

struct PlasticHistory::Record {
  PlasticStep step;
  PlasticReturn returned;
  ModeLanes displacement;  ///< increment
  PlasticPoint before;
  PlasticLanes plastic_strain;  ///< behind it
  // Adjoint.
  Voigt dual;            ///< tau^
  Amplitudes hourglass;  ///< eta
  PlasticLanes a, c;
  PlasticLanes ratio;  ///< dJ/dphi
};

}  // namespace fabseq
