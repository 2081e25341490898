// SPDX-License-Identifier: MIT
/// \file
/// Declaration of a config key. Validation, default, flat option, -help and the reference follow from it.
#pragma once

#include "fabseq/base/refusal.h"
#include "fabseq/keys/message.h"

#include <string>
#include <string_view>
#include <vector>

namespace fabseq {

/// What a key's value looks like. A "vector" has as many entries as the domain has dimensions.
enum class KeyType {
  of_member,  ///< follows from the type of the bound member (keys/member.h)
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
  vectors,         ///< list of vectors
  lengths,         ///< a number, or one per axis
  turns,           ///< list of pairs of an axis (a name or a vector) and degrees
  points,          ///< list of pairs of numbers
  profile,         ///< list of pairs of numbers, the first of which never descend; or empty
  list,            ///< list of any number of numbers
  angles,          ///< list of directions: lists of one angle in 2D, of two in 3D
  angle_bounds,    ///< two ascending numbers, or a list of such pairs
  word_list,       ///< list whose entries are among `words`
  shapes,          ///< list of shapes
  section,         ///< object with the keys of the section "SECTION.NAME"
  sections,        ///< list of objects with the keys of that section
  shape,           ///< object with exactly one shape, or a word
  part,            ///< shape or voxel file
  node_sets,       ///< object of named shapes
  starts,          ///< list of values of sequence.initial, which the rules across keys check
};

/// Declaration of a key. A Section fills in name, meaning, section and variant. From the member that the key
/// is bound to, it also fills in type and default if they are not given.
struct ConfigKey {
  KeyType type = KeyType::of_member;
  bool required = false;           ///< a key that is not required and has no default may be left out
  std::string default_value = "";  ///< JSON text
  std::string default_2d = "";     ///< JSON text of the default in 2D if it differs; "" otherwise
  std::string range = "";          ///< interval such as "(0, 1]" in which every number must lie; "" for any
  std::string words = "";          ///< allowed words, separated by blanks
  int dimension = 0;               ///< 2 or 3: exists only in domains of that dimension; 0: in all
  std::string unit = "";           ///< "" if it has none
  std::string option = "";         ///< flat command line option, with its '-'; "" if it has none
  bool source = false;             ///< among the keys of which a shape has exactly one
  std::string name = "", meaning = "";
  std::string section = "";  ///< dotted path of the object that holds the key; top level: empty
  std::string variant = "";  ///< the object's "type" for which the key exists; empty: any
};

/// The declarations of a section, and its title in -help and the reference.
struct SectionKeys {
  std::string path, title;
  std::vector<ConfigKey> keys;
};

/// The interval that ConfigKey::range describes.
struct Interval {
  double low, high;
  bool low_open, high_open;
  static Interval parse(std::string_view text);
  bool contains(double value) const;
  /// Text for messages: " > 0", " in (0, 1]"; "" if everything is allowed.
  std::string text() const;
};

std::vector<std::string> split(std::string_view text, char separator);
/// Dotted path of the section that a key of type `section` holds.
std::string subsection(const ConfigKey& key);
/// JSON text of the value that a user gave to a flat option: "80,40,80" becomes "[80,40,80]".
std::string flat_option_value(const ConfigKey& key, const std::string& text);
/// The values that the key takes, in words, for domains of `dimension` dimensions; 0: for any domain.
std::string allowed_values(const ConfigKey& key, int dimension);

}  // namespace fabseq
