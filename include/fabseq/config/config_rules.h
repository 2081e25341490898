// SPDX-License-Identifier: MIT
/// \file
/// What the table of keys (schema.h) cannot say: shapes from JSON, and relations between keys.
#pragma once

#include "fabseq/config/command_line.h"
#include "fabseq/config/config.h"

#include <string>

namespace fabseq {

/// The shape in a completed config object (one shape key, maybe others beside it). `pointer`: JSON pointer of
/// the object, for messages. Throws InputError for empty boxes, cylinders without length and normals of
/// length 0.
Shape make_shape(const Json& value, const std::string& pointer);

/// The layers of a completed config; `plate`: whose normal print directions have by default.
LayerSettings make_layer_settings(const Json& value, const BuildPlate& plate, int dimension);

/// Checks relations between keys of a config whose single values are valid. Throws InputError. The same on
/// all ranks.
void check_rules(const Config& config);

/// What a task needs beyond a valid config. Throws InputError. The same on all ranks.
void check_task(const Config& config, Task task);

}  // namespace fabseq
