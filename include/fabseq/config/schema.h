// SPDX-License-Identifier: MIT
/// \file
/// The one table of config keys: from it come validation, defaults, flat options, -help and the reference in
/// the manual.
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/base/refusal.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fabseq {

/// What a key's value looks like. "Vector": as many entries as the domain has dimensions.
enum class KeyType {
  flag,
  integer,
  number,
  text,
  path,            ///< file name, relative to the config file
  choice,          ///< one of `words`
  axis,            ///< x, y (z)
  face,            ///< x-, x+, y-, ...
  vector,          ///< numbers
  integer_vector,  ///< integers
  bounds,          ///< two ascending numbers
  strain,          ///< Voigt vector: 3 numbers in 2D, 6 in 3D; or an object with tangential and normal
  points,          ///< list of pairs of numbers
  list,            ///< list of any number of numbers
  angles,          ///< list of directions: lists of one angle in 2D, of two in 3D
  angle_bounds,    ///< two ascending numbers, or a list of such pairs
  word_list,       ///< list of some of `words`
  shapes,          ///< list of shapes
  section,         ///< object with the keys of the section "SECTION.NAME"
  sections,        ///< list of such objects
  shape,           ///< object with exactly one shape, or a word
  part,            ///< shape or voxel file
  node_sets,       ///< object of named shapes
  unavailable,     ///< documented for later; refused
};

/// Declaration of a key. Texts are views of literals.
struct ConfigKey {
  std::string_view section = "";  ///< dotted path of the object that holds the key; top level: empty
  std::string_view variant = "";  ///< the object's "type" for which the key exists; empty: any
  std::string_view name = "";
  KeyType type = KeyType::number;
  bool required = false;                ///< neither required nor default_value: may be left out
  std::string_view default_value = "";  ///< JSON text
  std::string_view default_2d = "";     ///< where it differs in two dimensions
  std::string_view range = "";          ///< interval such as "(0, 1]" for every number
  std::string_view words = "";          ///< allowed words, separated by blanks
  int dimension = 0;                    ///< 2 or 3: only in domains of that dimension
  std::string_view unit = "";           ///< "" where it has none
  std::string_view option = "";         ///< flat command line option, with its '-'
  std::string_view meaning = "";
};

/// Title of a section in -help and the reference.
struct ConfigSection {
  std::string_view path;
  std::string_view title;
};

/// All keys, section by section.
std::span<const ConfigKey> config_keys();
/// All sections in the order in which they are documented.
std::span<const ConfigSection> config_sections();

/// Interval of a ConfigKey::range.
struct Interval {
  double low, high;
  bool low_open, high_open;
  static Interval parse(std::string_view text);
  bool contains(double value) const;
  /// " > 0", " in (0, 1]", "" where everything is allowed.
  std::string text() const;
};

std::vector<std::string> split(std::string_view text, char separator);
/// Path of the section that a section key opens.
std::string subsection(const ConfigKey& key);
/// Path of the key for -set: "layers.count"; in lists by type: "objective.layer_uniformity.weight".
std::string dotted_path(const ConfigKey& key);
/// The key with that flat option, nullptr where there is none.
const ConfigKey* find_flat_option(std::string_view option);
/// JSON text of the value a user gave to a flat option: "80,40,80" becomes "[80,40,80]".
std::string flat_option_value(const ConfigKey& key, const std::string& text);
/// What values the key takes, in words; dimension 0: of any domain.
std::string allowed_values(const ConfigKey& key, int dimension);

/// The word that was probably meant (smallest edit distance), empty where none is near: `most` letters away
/// at most, by default a third of the word's.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words,
                         std::optional<std::size_t> most = {});
/// Pointer with the member or list index appended (RFC 6901).
std::string pointer_to(const std::string& pointer, const std::string& member);
std::string pointer_to(const std::string& pointer, std::size_t index);

/// Checks every key of `document` against the table and returns it complete: keys in the order of the table,
/// defaults filled in, paths absolute (relative ones refer to `directory`), without the key "run". Relations
/// between keys are make_config()'s. Throws InputError.
Json complete_config(const Json& document, const std::string& directory);

}  // namespace fabseq
