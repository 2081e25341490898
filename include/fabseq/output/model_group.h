// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/hdf5_writer.h"
#include "fabseq/model/model.h"
#include "fabseq/process/built_strain.h"

namespace fabseq {

/// Writes the group `model` of result.h5: what was held, built and measured, for tools that would have to
/// find it out again otherwise (docs/developer/files.md). Collective on the world of the run; throws
/// OutputError on all ranks.
/// \param strain  for the layers that the file's `layer` numbers
template <int Dim>
void write_model_group(Hdf5Writer& file, const Model<Dim>& model, const BuiltStrain& strain);

}  // namespace fabseq
