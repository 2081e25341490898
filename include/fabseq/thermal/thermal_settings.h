// SPDX-License-Identifier: MIT
/// \file
/// Heat conduction through the layers: what a config says of it, and what follows (docs/formulation.md 14).
#pragma once

#include "fabseq/process/process_settings.h"
#include "fabseq/thermal/integrated_curve.h"

#include <array>
#include <optional>

namespace fabseq {

template <class Settings>
class Section;

/// Section "thermal". Temperatures are in degrees Celsius.
struct ThermalSettings {
  std::optional<double> conductivity;     ///< k, W/(length K); none: the material's
  std::optional<double> heat_capacity;    ///< c, J/(kg K); none: the material's
  double heat_input = 0.0;                ///< Q, J per kg of deposited wire
  std::optional<double> vanishing;        ///< T_v, at which the strain vanishes; none: the material's
  double film_coefficient = 0.0;          ///< h, W/(length^2 K)
  double ambient = 20.0;                  ///< T_a, of the air
  double plate = 20.0;                    ///< T_p, held on the plate's face of the box
  double reference = 20.0;                ///< T_r, at which the inherent strain holds
  std::optional<int> given_passes;        ///< m; none: layers.passes
  int passes = 1;                         ///< m, real layers per simulated layer, once complete
  std::optional<double> interpass_limit;  ///< what pauses are reported for
  std::array<int, 2> steps = {4, 4};      ///< n_d while material is deposited, n_w in the last pause
};

/// Section "thermal".
Section<ThermalSettings> thermal_keys();
/// Checks what a block needs of other sections, and relations between its keys. Throws InputError. Not
/// collective.
void check_thermal(const ThermalSettings& thermal, const MaterialSettings& material,
                   const ProcessSettings& process);

/// What the steps in time need, each from the section that has it.
struct ThermalProperties {
  /// `thermal` has passed check_thermal() with these.
  ThermalProperties(const ThermalSettings& thermal, const MaterialSettings& material,
                    const ProcessSettings& process);

  double conductivity;                          ///< k, W/(length K)
  IntegratedCurve conduction;                   ///< factor on it by the excess over the air, K
  IntegratedCurve storage;                      ///< the same on the capacity
  double capacity;                              ///< mass density times heat capacity, J/(length^3 K)
  double heat;                                  ///< that new material brings, J/length^3
  double mass_density;                          ///< kg/length^3
  double rate;                                  ///< of deposition, kg/s
  double pause;                                 ///< w, after each real layer, s
  double film;                                  ///< h, W/(length^2 K)
  double ambient, plate, reference, vanishing;  ///< degrees Celsius
  int passes;                                   ///< m
  int welding_steps, pause_steps;               ///< of a layer

  /// Steps of a layer in all.
  int steps() const { return welding_steps + (pause > 0.0 ? pause_steps : 0); }
  double plate_excess() const { return plate - ambient; }
  /// Whether heat is conducted and stored alike at all temperatures: steps are linear.
  bool constant() const { return conduction.is_one() && storage.is_one(); }
  /// k over the capacity of the volume, length^2/s.
  double diffusivity() const { return conductivity / capacity; }
  /// s_j, the share of the inherent strain that a layer gets which begins at this temperature.
  double strain_share(double interpass) const;
  /// Returns the derivative of strain_share() with respect to the temperature, 1/K.
  double strain_share_slope(double interpass) const;
};

}  // namespace fabseq
