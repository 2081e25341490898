// SPDX-License-Identifier: MIT
#include "mesh/other_formats.h"

#include "mesh/text_values.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

using Known = std::pair<std::string_view, const char*>;
using namespace std::string_view_literals;

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
    {"glTF"sv, "a glTF file"},
    {"BLENDER"sv, "a Blender file"},
    {"Kaydara FBX"sv, "an FBX file"},
    {"3D Geometry File Format"sv, "a Rhino file (3DM)"},
    {"ACIS BinaryFile"sv, "an ACIS file (SAB)"},
    {"ASM BinaryFile"sv, "an ACIS file (SAB)"},
    {"V5_CFV2"sv, "a CATIA file"},
    {"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv, "a file of SolidWorks, Inventor or Office"},
    {"AC10"sv, "a DWG file"},
    {"\xff\xfe"sv, "text in UTF-16: save it as ASCII or UTF-8"},
    {"\xfe\xff"sv, "text in UTF-16: save it as ASCII or UTF-8"},
};

/// Beginnings in lower case, behind white space.
constexpr Known by_text[] = {
    {"version https://git-lfs"sv, "a pointer of Git LFS, not the file itself: `git lfs pull` fetches it"},
    {"<!doctype html"sv, "an HTML page: perhaps a download that needs a login"},
    {"<html"sv, "an HTML page: perhaps a download that needs a login"},
    {"<vtkfile"sv, "a VTK file"},
    {"<amf"sv, "an AMF file"},
    {"<collada"sv, "a COLLADA file"},
    {"<x3d"sv, "an X3D file"},
    {"iso-10303-21"sv, "a STEP file"},
    {"**part1"sv, "a Parasolid file"},
    {"# vtk"sv, "a VTK file"},
    {"# vrml"sv, "a VRML file"},
    {"#vrml"sv, "a VRML file"},
    {"$meshformat"sv, "a Gmsh file (MSH)"},
    {"meshversionformatted"sv, "a Medit file (MESH)"},
    {"dbrep_drawable"sv, "an OpenCASCADE file (BREP)"},
    {"casca"sv, "an OpenCASCADE file (BREP)"},
};

/// Endings in lower case, for what only its name tells.
constexpr Known by_ending[] = {
    {".off"sv, "an OFF file"},
    {".unv"sv, "an I-DEAS file (UNV)"},
    {".bdf"sv, "a Nastran file (BDF)"},
    {".nas"sv, "a Nastran file (BDF)"},
    {".fem"sv, "a Nastran file (BDF)"},
    {".inp"sv, "an Abaqus or CalculiX file (INP)"},
    {".cdb"sv, "an Ansys file (CDB)"},
    {".k"sv, "an LS-DYNA file"},
    {".key"sv, "an LS-DYNA file"},
    {".msh"sv, "a Gmsh or Fluent file (MSH)"},
    {".mesh"sv, "a Medit file (MESH)"},
    {".med"sv, "a Salome file (MED)"},
    {".vtk"sv, "a VTK file"},
    {".vtp"sv, "a VTK file"},
    {".vtu"sv, "a VTK file"},
    {".step"sv, "a STEP file"},
    {".stp"sv, "a STEP file"},
    {".iges"sv, "an IGES file"},
    {".igs"sv, "an IGES file"},
    {".brep"sv, "an OpenCASCADE file (BREP)"},
    {".x_t"sv, "a Parasolid file"},
    {".x_b"sv, "a Parasolid file"},
    {".sat"sv, "an ACIS file (SAT)"},
    {".sab"sv, "an ACIS file (SAB)"},
    {".jt"sv, "a JT file"},
    {".3dm"sv, "a Rhino file (3DM)"},
    {".sldprt"sv, "a SolidWorks file"},
    {".catpart"sv, "a CATIA file"},
    {".ipt"sv, "an Inventor file"},
    {".fcstd"sv, "a FreeCAD file"},
    {".scad"sv, "an OpenSCAD file"},
    {".dxf"sv, "a DXF file"},
    {".dwg"sv, "a DWG file"},
    {".skp"sv, "a SketchUp file"},
    {".blend"sv, "a Blender file"},
    {".gltf"sv, "a glTF file"},
    {".glb"sv, "a glTF file"},
    {".fbx"sv, "an FBX file"},
    {".dae"sv, "a COLLADA file"},
    {".x3d"sv, "an X3D file"},
    {".wrl"sv, "a VRML file"},
    {".3ds"sv, "a 3DS file"},
    {".amf"sv, "an AMF file"},
    {".gcode"sv, "a G-code file"},
    {".gco"sv, "a G-code file"},
};

/// Formats in which solids have no triangles.
constexpr std::string_view of_solids[] = {"STEP",    "IGES",       "Parasolid", "ACIS",     "CATIA", "JT",
                                          "FreeCAD", "SolidWorks", "Inventor",  "OpenCASC", "Rhino"};

/// IGES has lines of 80 columns with the section in column 73, S first.
bool is_iges(std::string_view text) {
  const std::size_t end = text.find_first_of("\r\n");
  return end == 80 && text[72] == 'S' &&
         text.substr(73, 7).find_first_not_of(" 0123456789") == std::string_view::npos;
}

/// The first lines of a text in lower case, without white space at their ends, and without empty ones.
std::vector<std::string> first_lines(std::string_view text) {
  constexpr std::size_t most_bytes = 20000;
  constexpr const char* blank = " \t\r\v\f";
  std::vector<std::string> lines;
  text = text.substr(0, most_bytes);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t first = line.find_first_not_of(blank);
    if (first == std::string_view::npos) continue;
    lines.push_back(lower_case(line.substr(first, line.find_last_not_of(blank) + 1 - first)));
  }
  return lines;
}

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789") == std::string_view::npos;
}

/// The word "off", in front of which letters may say what else vertices have.
bool is_off(const std::string& line) {
  const std::string word = line.substr(0, line.find_first_of(" \t"));
  return word.ends_with("off") &&
         word.substr(0, word.size() - 3).find_first_not_of("stcn4") == std::string::npos;
}

/// Formats whose first lines say what they are, behind comments.
std::string format_of_lines(const std::vector<std::string>& lines) {
  const auto first_without = [&](std::string_view comment) -> std::string {
    const auto found = std::find_if(lines.begin(), lines.end(),
                                    [&](const std::string& line) { return !line.starts_with(comment); });
    return found != lines.end() ? *found : "";
  };
  if (lines.empty()) return "";
  if (is_off(first_without("#"))) return "an OFF file";
  if (lines.size() > 1 && lines[0] == "-1" && is_number(lines[1])) return "an I-DEAS file (UNV)";
  const std::string keyword = first_without("**");
  if (keyword.size() > 1 && keyword[0] == '*' && keyword[1] >= 'a' && keyword[1] <= 'z')
    return lines[0].starts_with("*keyword") ? "an LS-DYNA file" : "an Abaqus or CalculiX file (INP)";
  for (const std::string& line : lines)
    for (const std::string_view card : {"begin bulk", "grid,", "grid ", "grid*", "cend"})
      if ((line + " ").starts_with(card)) return "a Nastran file (BDF)";
  return "";
}

/// What to do about a format, after its name.
std::string advice(std::string_view name) {
  if (name.find(':') != std::string_view::npos || name.find(';') != std::string_view::npos) return "";
  const bool solid = std::any_of(std::begin(of_solids), std::end(of_solids), [&](std::string_view of) {
    return name.find(of) != std::string_view::npos;
  });
  if (solid) return ", which has no triangles: export STL or 3MF from the CAD program";
  const bool document = name.find("PDF") != std::string_view::npos ||
                        name.find("picture") != std::string_view::npos ||
                        name.find("archive") != std::string_view::npos;
  return document ? "" : ": export its surface as STL, OBJ, PLY or 3MF";
}

std::string name_of(std::string_view file) {
  if (file.find_first_not_of(" \t\r\n\v\f") == std::string_view::npos) return "empty";
  for (const auto& [start, name] : by_bytes)
    if (file.starts_with(start)) return name;
  const std::string_view marked = without_mark(file);
  const std::string_view text = marked.substr(std::min(marked.find_first_not_of(" \t\r\n"), marked.size()));
  const bool declared = text.starts_with("<?xml");
  const std::size_t end = declared ? text.find("?>") : std::string_view::npos;
  const std::string_view body = end == std::string_view::npos ? text : text.substr(end + 2);
  const std::string start =
      lower_case(body.substr(std::min(body.find_first_not_of(" \t\r\n"), body.size())).substr(0, 64));
  for (const auto& [known, name] : by_text)
    if (start.starts_with(known)) return name;
  if (declared) return "an XML file outside a ZIP archive: no format that is known";
  if (is_iges(marked)) return "an IGES file";
  return format_of_lines(first_lines(marked));
}

}  // namespace

std::string other_format(std::string_view file) {
  const std::string name = name_of(file);
  return name.empty() || name == "empty" ? name : name + advice(name);
}

std::string format_by_ending(std::string_view ending) {
  for (const auto& [known, name] : by_ending)
    if (ending == known) return name + advice(name);
  return "";
}

}  // namespace fabseq
