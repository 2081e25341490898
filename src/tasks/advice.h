// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/config/setup.h"

#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// What -task check says about settings that are allowed and seldom meant
/// (docs/how-to/choose-what-to-optimize.md): layers of too few elements, a number of layers or a
/// characteristic length that does not go with the target thickness, a continuation that does not end, a node
/// set that the last layers build. One text each. `distance`: geodesic_distance() of the part. Collective on
/// the grid's communicator.
template <int Dim>
std::vector<std::string> advice(const Setup<Dim>& setup, std::span<const double> distance,
                                double geodesic_height);

/// Thickness of a layer in elements: the target where there is one, else the geodesic height shared out.
template <int Dim>
double elements_per_layer(const Setup<Dim>& setup, double geodesic_height);

/// The same of a real layer, each of those that a layer stands for. Collective on the grid's communicator.
template <int Dim>
double elements_per_bead(const Setup<Dim>& setup);

}  // namespace fabseq
