// SPDX-License-Identifier: MIT
/// \file
/// Declaration of a config key: from it come validation, default, flat option, -help and the reference.
#pragma once

#include "fabseq/base/refusal.h"
#include "fabseq/keys/message.h"

#include <string>
#include <string_view>
#include <vector>

namespace fabseq {

/// What a key's value looks like. "Vector": as many entries as the domain has dimensions.
enum class KeyType {
  of_member,  ///< what the type of the bound member says (keys/member.h)
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

/// Declaration of a key. A Section fills in name, meaning, section and variant and, from the member that the
/// key is bound to, type and default where they are not given.
struct ConfigKey {
  KeyType type = KeyType::of_member;
  bool required = false;           ///< neither required nor default_value: may be left out
  std::string default_value = "";  ///< JSON text
  std::string default_2d = "";     ///< where it differs in two dimensions
  std::string range = "";          ///< interval such as "(0, 1]" for every number
  std::string words = "";          ///< allowed words, separated by blanks
  int dimension = 0;               ///< 2 or 3: only in domains of that dimension
  std::string unit = "";           ///< "" where it has none
  std::string option = "";         ///< flat command line option, with its '-'
  std::string name = "", meaning = "";
  std::string section = "";  ///< dotted path of the object that holds the key; top level: empty
  std::string variant = "";  ///< the object's "type" for which the key exists; empty: any
};

/// The declarations of a section, and its title in -help and the reference.
struct SectionKeys {
  std::string path, title;
  std::vector<ConfigKey> keys;
};

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
/// JSON text of the value a user gave to a flat option: "80,40,80" becomes "[80,40,80]".
std::string flat_option_value(const ConfigKey& key, const std::string& text);
/// What values the key takes, in words; dimension 0: of any domain.
std::string allowed_values(const ConfigKey& key, int dimension);

}  // namespace fabseq
