// SPDX-License-Identifier: MIT
/// \file
/// The sequences that a model asks for.
#pragma once

#include "fabseq/model/model.h"
#include "fabseq/sequence/sequence.h"

#include <memory>

namespace fabseq {

/// The sequence a model asks for.
template <int Dim>
std::unique_ptr<Sequence<Dim>> make_sequence(const Model<Dim>& model, double tolerance);
/// A sequence of the model's kind with other settings, which must outlive it.
template <int Dim>
std::unique_ptr<Sequence<Dim>> make_other_sequence(const Model<Dim>& model, const SequenceSettings& settings,
                                                   double tolerance);
/// The planar sequence of the baseline.
template <int Dim>
std::unique_ptr<Sequence<Dim>> make_baseline_sequence(const Model<Dim>& model);

}  // namespace fabseq
