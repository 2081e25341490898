// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/machine/tool_settings.h"
#include "fabseq/part/part.h"

#include <array>
#include <span>
#include <vector>

namespace fabseq {

/// The space that a torch takes, with its clearance: a body of revolution around its axis
/// (docs/formulation.md 13.1). Heights are measured from the tip along the axis, in length units.
class Torch {
 public:
  /// `settings`: with a profile.
  explicit Torch(const ToolSettings& settings);

  /// Radius at a height; -infinity below and above the torch. Heights and distances that differ from an end
  /// by rounding count as there.
  double radius(double height) const;
  /// The largest radius between two heights; -infinity if the torch is nowhere between them.
  double largest_radius(double low, double high) const;
  /// Distance from the tip beyond which there is nothing of the torch.
  double reach() const;

 private:
  std::vector<std::array<double, 2>> profile_;  ///< height, radius with the clearance
  double rounding_;
};

/// Width of an element halo that holds everything within the torch's reach. Local.
template <int Dim>
Index<Dim> torch_halo(const Grid<Dim>& grid, const Torch& torch);

/// Axis of a torch that does not turn, of unit length. Not collective. \param settings  with an axis
template <int Dim>
Point<Dim> fixed_torch_axis(const ToolSettings& settings);

/// The torch's axis at each part element, [part element][axis], of unit length: the axis of the settings or
/// else the build direction, and the plate's normal where that is zero. Empty where neither is defined.
/// Local. \param direction  build_direction()
template <int Dim>
std::vector<double> torch_axis(const Part<Dim>& part, const ToolSettings& settings,
                               std::span<const double> direction);

/// Angle between the torch's axis and the plate's normal at each part element, in degrees; empty without an
/// axis. Local.
template <int Dim>
std::vector<double> torch_tilt(const Part<Dim>& part, std::span<const double> axis);

/// Points that fill a torch with its clearance, relative to its tip and for an axis along the plate's normal
/// `up`: denser near the tip, which comes nearest to the bead, and even over the disc at each height
/// (docs/developer/numerics.md 13.2). Not collective.
/// \param settings  with a profile
/// \param highest   height above which there is nothing that the torch could meet, length unit
/// \param count     number of points
template <int Dim>
std::vector<Point<Dim>> torch_samples(const ToolSettings& settings, const Point<Dim>& up, double highest,
                                      int count);

}  // namespace fabseq
