// SPDX-License-Identifier: MIT
/// \file
/// What a sequence asks of the machine, and what it leaves in the part.
#pragma once

#include "fabseq/chain/pipeline.h"
#include "fabseq/files/field_set.h"
#include "fabseq/machine/local_thickness.h"
#include "fabseq/machine/marked_elements.h"
#include "fabseq/machine/places.h"
#include "fabseq/machine/time_gradient.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// Residual stress of the part as built, on the plate.
struct StressNumbers {
  double von_mises = 0.0;           ///< largest equivalent stress, stress unit
  double share_beyond_yield = 0.0;  ///< of the part's volume
};

/// Angle between the torch's axis and the plate's normal.
struct TiltNumbers {
  double largest = 0.0;   ///< degrees
  MarkedElements beyond;  ///< by how much it is beyond tool.max_tilt
};

/// Elements whose time is beyond the last layer's by more than this, in layers, count as late.
inline constexpr double late_from = 0.25;

/// Where the checks fail, and what these places are measured by.
struct FaultyPlaces : Places {
  Bead bead;
  double part_volume = 0.0;
};

/// Figures of a sequence, the same on all ranks.
struct BuildNumbers {
  GradientSource gradient = GradientSource::sequence;  ///< what direction and thickness are found from
  double gradient_elsewhere = 0.0;                     ///< TimeGradient::share_elsewhere
  std::optional<MarkedElements> blocked;          ///< by how deep the torch is blocked; none without a torch
  std::optional<TiltNumbers> tilt;                ///< none where the torch's axis is not defined
  std::optional<ThicknessRange> local_thickness;  ///< none where it is not defined
  std::optional<MarkedElements> late;             ///< by how many layers beyond late_from; curved layers
  MarkedElements hanging;                         ///< elements that begin in the air
  MarkedElements interior_minima, interior_maxima;
  std::optional<FaultyPlaces> places;   ///< check_places() looks for them
  double stock = 0.0;                   ///< Part::share_of_stock()
  std::optional<double> wire, hours;    ///< kg; build time. None without density and deposition rate
  std::optional<StressNumbers> stress;  ///< where the config has a yield stress
};

/// The fields that these figures are taken from, on the owned elements of the part. None where they are not
/// defined, on all ranks alike.
struct BuildFields {
  std::optional<std::vector<double>> direction;        ///< [element][axis]
  std::optional<std::vector<double>> blocked;          ///< depth, length unit; 0 where the torch gets
  std::optional<std::vector<double>> tilt;             ///< of the torch's axis, degrees
  std::optional<std::vector<double>> local_thickness;  ///< length unit
  std::optional<std::vector<double>> hanging;          ///< 1 where an element begins in the air
  std::optional<std::vector<double>> fault;            ///< number of a Fault, 0: none; with the places
  std::optional<std::vector<double>> von_mises;        ///< equivalent residual stress, with a yield stress
};

/// Adds those that there are to a set, names prefixed. They and the part must outlive it.
template <int Dim>
void add_build_fields(FieldSet<Dim>& fields, const Part<Dim>& part, const BuildFields& build,
                      const std::string& prefix);

struct BuildReport {
  BuildNumbers numbers;
  BuildFields fields;
};

/// By how much each part element fails a check, > 0 where it does; none where the check is not made.
std::optional<std::vector<double>> fault_marks(const BuildFields& fields, const ModelSettings& settings,
                                               Fault fault);

/// The checks of a pseudo-time cut into layers (docs/formulation.md 13.1). `layers`: only time points,
/// sub-parts and the number of layers count. `layer_index`: the layer of each part element, from 1.
/// `with_places`: with the places at which the checks fail. Collective.
template <int Dim>
BuildReport check_layers(const Model<Dim>& model, const PseudoTime<Dim>& time, const LayerDensities& layers,
                         std::vector<double> layer_index, bool with_places);

/// The checks of a pipeline's last run, of its binary layers whatever layers it ran with (docs/formulation.md
/// 13.1). Collective.
template <int Dim>
BuildReport check_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                        const StageResults<Dim>& state);

/// The same with the places at which they fail. Collective.
template <int Dim>
BuildReport check_places(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const StageResults<Dim>& state);

/// The same with build time, wire and stress. `used_layers`: those with more than a trace of the volume.
/// Collective.
template <int Dim>
BuildReport report_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const StageResults<Dim>& state, int used_layers);

}  // namespace fabseq
