// SPDX-License-Identifier: MIT
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace fabseq {

class ZipArchive;

/// An object of a 3MF file by the model that it stands in and its number there.
struct ThreeMfName {
  std::string file, number;

  auto operator<=>(const ThreeMfName&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14
};

/// What the models of a 3MF file say that lib3mf does not.
struct ThreeMfContents {
  struct Object {
    std::string type = "model";
    std::vector<ThreeMfName> components;  ///< in their order
  };
  struct Item {
    ThreeMfName object;
    bool printable = true;
  };

  std::map<ThreeMfName, Object> objects;
  std::vector<Item> items;            ///< of the build, in their order
  std::set<std::string> other_files;  ///< that the items and components name
  std::int64_t lattices = 0;          ///< beam lattices in it
};

/// Looks through a model and those that it names. Errors are InputError: for what is damaged, for a triangle
/// with a corner that is no vertex, for a model that is named and not there, and for shapes that only an
/// extension of 3MF describes.
ThreeMfContents read_three_mf_contents(const ZipArchive& archive, const std::string& root);

/// The name of a file in an archive for what relations and models call it.
std::string in_archive(std::string_view part);

}  // namespace fabseq
