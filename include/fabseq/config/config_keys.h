// SPDX-License-Identifier: MIT
/// \file
/// All keys of a config: the sections of the modules, put together.
#pragma once

#include "fabseq/config/config.h"
#include "fabseq/keys/section.h"

#include <string>
#include <string_view>
#include <vector>

namespace fabseq {

/// The whole config.
const Section<Config>& config_section();
/// All sections in the order in which they are documented.
const std::vector<SectionKeys>& config_sections();
/// Path of the key for -set: "layers.count"; in lists by type: "objective.layer_uniformity.weight".
std::string dotted_path(const ConfigKey& key);
/// The key with that flat option, nullptr where there is none.
const ConfigKey* find_flat_option(std::string_view option);
/// All flat options.
std::vector<std::string> flat_options();

/// Checks every key of `document` against the sections and returns it complete: keys in the order of the
/// sections, defaults filled in, paths absolute (relative ones refer to `directory`), without the key "run".
/// Relations between keys are make_config()'s. Throws InputError.
Json complete_config(const Json& document, const std::string& directory);

}  // namespace fabseq
