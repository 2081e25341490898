// SPDX-License-Identifier: MIT
/// \file
/// Material and material model of the simulation.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

inline constexpr double seconds_per_hour = 3600.0;  ///< rates are per hour, pauses in seconds

template <class Settings>
class Section;

/// Inherent strain along and across the layers, docs/formulation.md 4.2.
struct TurningStrain {
  double tangential = 0.0, normal = 0.0;
};

struct MaterialSettings {
  double young = 1.0;  ///< stress unit
  double poisson = 0.3;
  /// Voigt order xx,yy,zz,xy,yz,zx (2D xx,yy,xy), engineering shear; strain_scale applied; empty where it
  /// turns
  std::vector<double> inherent_strain;
  std::optional<TurningStrain> turning_strain = std::nullopt;
  std::vector<double> strain_scale = {};  ///< one factor per axis, for strains that turn
  std::vector<std::vector<double>> scenarios =
      {};                 ///< [scenario]: one factor per axis, on top of strain_scale
  std::string name = {};  ///< a label, empty: none
  std::optional<double> mass_density = std::nullopt;  ///< kg / length^3
  std::optional<double> yield_stress = std::nullopt;  ///< stress unit
  double hardening = 0.0;                             ///< stress per plastic strain
  // By temperature, for plastic flow (MaterialCurves) and heat (ThermalProperties); empty: no dependence.
  std::vector<double> temperatures = {};  ///< degrees Celsius, ascending
  std::vector<double> young_factors = {}, yield_factors = {};
  std::vector<double> elongations = {};          ///< free strain
  std::optional<double> cut_off = std::nullopt;  ///< no thermal strain above, degrees Celsius
  // What a block `thermal` takes where it says "material".
  std::optional<double> conductivity = std::nullopt;    ///< W/(length K)
  std::optional<double> heat_capacity = std::nullopt;   ///< J/(kg K)
  std::optional<double> solidification = std::nullopt;  ///< degrees Celsius
  std::vector<double> conductivity_factors = {}, heat_capacity_factors = {};
};

enum class VoidModel { absent, quiet };

/// What the material of a process does: it is linear elastic, or flows beyond its yield stress.
enum class ProcessModel { linear, elastoplastic };

/// Where new material goes: where the drawing says, or with what stands already (docs/formulation.md 4.6).
enum class DepositionModel { nominal, follow };

/// The material model, docs/formulation.md 4.1.
struct ProcessSettings {
  ProcessModel model = ProcessModel::linear;
  double stiffness_penalty = 3.0;
  double strain_penalty = 3.0;
  double min_stiffness = 1e-9;
  VoidModel void_model = VoidModel::absent;
  DepositionModel deposition = DepositionModel::nominal;
  std::optional<double> deposition_rate = std::nullopt;  ///< kg of wire per hour
  double dwell = 0.0;                                    ///< pause after each layer, s

  /// Stage density above which an element stands: it is more than about twice as stiff as the least.
  double least_standing() const { return std::pow(min_stiffness, 1.0 / stiffness_penalty); }
};

/// Whether solves may leave out what is not built yet (docs/formulation.md 4.8): nothing counts there.
inline bool may_leave_out_unbuilt(const ProcessSettings& process) {
  return process.void_model == VoidModel::absent && process.deposition == DepositionModel::nominal;
}

/// Factors on the Voigt components of a strain that is scaled by one factor per axis: shear by the root of
/// the product of its two (docs/formulation.md 4.5).
std::vector<double> voigt_factors(const std::vector<double>& of_axes);

/// Sections "material" and "process".
Section<MaterialSettings> material_keys();
Section<ProcessSettings> process_keys();

}  // namespace fabseq
