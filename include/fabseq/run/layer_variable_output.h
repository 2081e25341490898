// SPDX-License-Identifier: MIT
/// \file
/// The variables of the layers in files: time_points or angles, where a design has them.
#pragma once

#include "fabseq/files/hdf5_writer.h"
#include "fabseq/layers/layer_variables.h"
#include "fabseq/optimize/design.h"

#include <string>

namespace fabseq {

/// A dataset GROUP + their name; `group` ends in '/' or is empty. Collective on the writer's communicator.
inline void write_layer_variables(Hdf5Writer& file, const LayerVariables& variables, const std::string& group,
                                  const Design& design) {
  if (!design.layer_variables.empty())
    file.write_array(group + variables.name, design.layer_variables, variables.columns);
}

/// A member of a record.
inline void set_layer_variables(Json& record, const LayerVariables& variables, const Design& design) {
  if (!design.layer_variables.empty()) record[variables.name] = variables.record(design.layer_variables);
}

}  // namespace fabseq
