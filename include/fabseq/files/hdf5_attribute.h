// SPDX-License-Identifier: MIT
/// \file
/// Scalars as HDF5 attributes. Nothing here is collective.
#pragma once

#include "fabseq/base/json.h"

#include <hdf5.h>

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// Writes an attribute of `object`, replacing one of the same name: a boolean (as h5py does, an enum of FALSE
/// and TRUE), an integer (64 bits, with or without a sign), a number (a double, bit for bit) or a string
/// (UTF-8, variable length). Returns false if HDF5 fails. Throws std::invalid_argument for null, arrays and
/// objects.
bool write_attribute(hid_t object, const std::string& name, const Json& value);

/// Value of an attribute that write_attribute() wrote; none if it is missing, damaged or of another type.
std::optional<Json> read_attribute(hid_t object, const std::string& name);
/// Names of all attributes, sorted.
std::vector<std::string> attribute_names(hid_t object);

}  // namespace fabseq
