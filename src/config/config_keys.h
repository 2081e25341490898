// SPDX-License-Identifier: MIT
/// \file
/// All keys of a config: the sections of the modules, put together. Nothing here is collective.
#pragma once

#include "fabseq/config/config.h"
#include "fabseq/keys/section.h"

#include <string>
#include <vector>

namespace fabseq {

/// The section of the whole config.
const Section<Config>& config_section();
/// All sections in the order in which they are documented.
const std::vector<SectionKeys>& config_sections();
/// Path of a key for -set: "layers.count"; for keys in lists with the type of the entry:
/// "objective.layer_uniformity.weight".
std::string dotted_path(const ConfigKey& key);
/// The keys that have a flat option.
std::vector<const ConfigKey*> keys_with_option();

/// Checks every key of `document` against the sections and returns the document complete: keys in the order
/// of the sections, defaults filled in, paths absolute (relative ones refer to `directory`), without the key
/// "run". make_config() checks the relations between keys. Throws InputError.
Json complete_config(const Json& document, const std::string& directory);
/// The same for one section of the config at `pointer`, for a domain of `dimension` dimensions.
Json complete_section(const Json& value, const std::string& pointer, const std::string& path, int dimension,
                      const std::string& directory);

}  // namespace fabseq
