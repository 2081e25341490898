// SPDX-License-Identifier: MIT
/// \file
/// The measures of distortion, one source each (docs/formulation.md 5). Construction is collective on the
/// grid's communicator.
#pragma once

#include "responses/distortion.h"
#include "responses/set_displacement.h"

#include <memory>

namespace fabseq {

/// Sum over the set's nodes of |u|^2, or their mean. Sources: D24 eq. 31, W23 eq. 33, L23 eq. 3.39.
template <int Dim>
std::unique_ptr<Response<Dim>> make_displacement(const SetDisplacement<Dim>& set,
                                                 const DistortionSettings& settings);

/// ((1/n) sum of |u|^p)^(2/p) over the set's n nodes, p the norm, which must be given: from the mean square
/// (p = 2) to the square of the largest displacement (p towards infinity). 0, and so is its derivative, where
/// nothing moves. Source: ours.
template <int Dim>
std::unique_ptr<Response<Dim>> make_displacement_norm(const SetDisplacement<Dim>& set,
                                                      const DistortionSettings& settings);

/// Mean over the set's nodes of (u_a - mean of u_a)^2, a the axis. Sources: W23 eq. 31, D24 eq. 32.
template <int Dim>
std::unique_ptr<Response<Dim>> make_flatness(const SetDisplacement<Dim>& set,
                                             const DistortionSettings& settings);

/// Sum over layers and all nodes of |increment|^2. Source: M26 eq. 18.
template <int Dim>
std::unique_ptr<Response<Dim>> make_layerwise();

/// The deviation of a set's shape once it is aligned: the mean over its nodes of |u - R a|^2, a the
/// least-squares fit of the motions R. Throws InputError naming the node set if the nodes do not determine
/// the fit. Source: ours.
template <int Dim>
std::unique_ptr<Response<Dim>> make_shape_deviation(const SetDisplacement<Dim>& set,
                                                    const DistortionSettings& settings);

/// The squared change of the angle between the planes (in 2D the lines) fitted to two node sets, in degrees
/// squared. Throws InputError naming the node set that determines no plane. Sources: W23 section 3.1 for
/// perpendicular edges; ours for planes and any angle.
template <int Dim>
std::unique_ptr<Response<Dim>> make_angle_change(const SetDisplacement<Dim>& nodes,
                                                 const SetDisplacement<Dim>& to);

/// A distortion of one component, aggregated over the scenarios of material.scenarios, of which there must be
/// some. `of_increments`: whether it depends on single layers' increments. Not collective. Source: fabseq's
/// own.
template <int Dim>
std::unique_ptr<Response<Dim>> aggregated(std::unique_ptr<Response<Dim>> distortion, Aggregate aggregate,
                                          bool of_increments);

}  // namespace fabseq
