// SPDX-License-Identifier: MIT
#include "mesh/other_formats.h"

#include "mesh/text_values.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

using Known = std::pair<std::string_view, const char*>;
using namespace std::string_view_literals;

constexpr const char* solid_model = ", which has no triangles: export STL or 3MF from the CAD program";

constexpr Known by_bytes[] = {
    {"\x1f\x8b"sv, "a gzip archive: unpack it first"},
    {"BZh"sv, "a bzip2 archive: unpack it first"},
    {"\xfd"
     "7zXZ\0"sv,
     "an xz archive: unpack it first"},
    {"\x28\xb5\x2f\xfd"sv, "a zstd archive: unpack it first"},
    {"7z\xbc\xaf\x27\x1c"sv, "a 7-Zip archive: unpack it first"},
    {"Rar!"sv, "a RAR archive: unpack it first"},
    {"PK\5\6"sv, "an empty ZIP archive"},
    {"%PDF"sv, "a PDF document"},
    {"\x89PNG"sv, "a PNG picture"},
    {"\xff\xd8\xff"sv, "a JPEG picture"},
    {"\x89HDF"sv, "an HDF5 file; part.voxels reads densities from one"},
    {"glTF"sv, "a glTF file: export STL, OBJ, PLY or 3MF"},
    {"\xff\xfe"sv, "text in UTF-16: save it as ASCII or UTF-8"},
    {"\xfe\xff"sv, "text in UTF-16: save it as ASCII or UTF-8"},
};

/// In lower case, behind white space.
constexpr Known by_text[] = {
    {"version https://git-lfs"sv, "a pointer of Git LFS, not the file itself: `git lfs pull` fetches it"},
    {"<!doctype html"sv, "an HTML page: perhaps a download that needs a login"},
    {"<html"sv, "an HTML page: perhaps a download that needs a login"},
    {"<?xml"sv, "an XML file outside a ZIP archive"},
    {"iso-10303-21"sv, "a STEP file"},
    {"**part1"sv, "a Parasolid file"},
    {"# vtk"sv, "a VTK file: export STL, OBJ, PLY or 3MF"},
    {"# vrml"sv, "a VRML file: export STL, OBJ, PLY or 3MF"},
    {"#vrml"sv, "a VRML file: export STL, OBJ, PLY or 3MF"},
    {"off\n"sv, "an OFF file: export STL, OBJ, PLY or 3MF"},
    {"off\r"sv, "an OFF file: export STL, OBJ, PLY or 3MF"},
};

/// IGES has lines of 80 columns with the section in column 73, S first.
bool is_iges(std::string_view text) {
  const std::size_t end = text.find_first_of("\r\n");
  return end == 80 && text[72] == 'S' &&
         text.substr(73, 7).find_first_not_of(" 0123456789") == std::string_view::npos;
}

}  // namespace

std::string other_format(std::string_view file) {
  if (file.find_first_not_of(" \t\r\n\v\f") == std::string_view::npos) return "empty";
  for (const auto& [start, name] : by_bytes)
    if (file.starts_with(start)) return name;
  const std::string_view marked = without_mark(file);
  const std::string_view text = marked.substr(std::min(marked.find_first_not_of(" \t\r\n"), marked.size()));
  const std::string start = lower_case(text.substr(0, 64));
  for (const auto& [known, name] : by_text)
    if (start.starts_with(known)) return name + std::string(known.starts_with("iso") ? solid_model : "");
  if (is_iges(marked)) return std::string("an IGES file") + solid_model;
  return "";
}

}  // namespace fabseq
