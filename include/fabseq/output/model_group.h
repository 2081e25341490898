// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/hdf5_writer.h"
#include "fabseq/optimize/model.h"

#include <span>

namespace fabseq {

/// Writes the group `model` of result.h5: what was held, built and measured, for tools that would have to
/// find it out again otherwise (docs/reference.md, The group model).
/// \param strain  ElasticModel::strain_when_built() for the layers that the file's `layer` numbers
/// Collective on the world of the run; throws OutputError on all ranks.
template <int Dim>
void write_model_group(Hdf5Writer& file, const Model<Dim>& model, std::span<const double> strain);

}  // namespace fabseq
