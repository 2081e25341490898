// SPDX-License-Identifier: MIT
/// \file
/// Meshes as the text or bytes of files, for tests.
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace fabseq::test {

inline std::string line(const std::string& words, const Point<3>& point) {
  std::string text = words;
  for (const double coordinate : point) text += " " + std::to_string(coordinate);
  return text + "\n";
}

template <class T>
std::string bytes(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

inline std::string ascii_stl(const TriangleMesh& mesh) {
  std::string text = "solid part\n";
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const Point<3>& corner : mesh.corners(t)) text += line("vertex", corner);
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid part\n";
}

inline std::string binary_stl(const TriangleMesh& mesh) {
  std::string text(80, ' ');
  text += bytes(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    text += std::string(12, '\0');
    for (const Point<3>& corner : mesh.corners(t))
      for (const double coordinate : corner) text += bytes(static_cast<float>(coordinate));
    text += std::string(2, '\0');
  }
  return text;
}

inline std::string obj(const TriangleMesh& mesh) {
  std::string text = "# a part\no part\n";
  for (const Point<3>& point : mesh.points) text += line("v", point);
  for (const auto& [a, b, c] : mesh.triangles)
    text += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
  return text;
}

inline std::string ply(const TriangleMesh& mesh) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.points.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(mesh.triangles.size()) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Point<3>& point : mesh.points) text += line("", point).substr(1);
  for (const auto& [a, b, c] : mesh.triangles)
    text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  return text;
}

inline std::uint32_t checksum(const std::string& text) {
  std::uint32_t value = 0xffffffff;
  for (const unsigned char byte : text) {
    value ^= byte;
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ ((value & 1) != 0 ? 0xedb88320 : 0);
  }
  return ~value;
}

/// A zip archive whose entries are not compressed, or have the form of compressed ones.
inline std::string zip(const std::vector<std::pair<std::string, std::string>>& entries,
                       bool deflated = false) {
  std::string text, directory;
  for (const auto& [name, content] : entries) {
    const auto size = static_cast<std::uint16_t>(content.size());
    const std::string packed =
        (deflated ? "\1" + bytes(size) + bytes(static_cast<std::uint16_t>(~size)) : "") + content;
    const std::string common = bytes<std::uint16_t>(20) + bytes<std::uint16_t>(0) +
                               bytes<std::uint16_t>(deflated ? 8 : 0) + std::string(4, '\0') +
                               bytes(checksum(content)) + bytes(static_cast<std::uint32_t>(packed.size())) +
                               bytes(static_cast<std::uint32_t>(content.size())) +
                               bytes(static_cast<std::uint16_t>(name.size())) + bytes<std::uint16_t>(0);
    directory += "PK\1\2" + bytes<std::uint16_t>(20) + common + std::string(10, '\0') +
                 bytes(static_cast<std::uint32_t>(text.size())) + name;
    text += "PK\3\4" + common + name + packed;
  }
  const auto count = static_cast<std::uint16_t>(entries.size());
  return text + directory + "PK\5\6" + std::string(4, '\0') + bytes(count) + bytes(count) +
         bytes(static_cast<std::uint32_t>(directory.size())) +
         bytes(static_cast<std::uint32_t>(text.size())) + bytes<std::uint16_t>(0);
}

/// The resource of a 3MF file for a mesh; `type` is model, support, ...
inline std::string three_mf_object(int number, const TriangleMesh& mesh, const std::string& type = "model") {
  std::string text = "<object id=\"" + std::to_string(number) + "\" type=\"" + type + "\"><mesh><vertices>";
  for (const auto& [x, y, z] : mesh.points)
    text += "<vertex x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y) + "\" z=\"" +
            std::to_string(z) + "\"/>";
  text += "</vertices><triangles>";
  for (const auto& [a, b, c] : mesh.triangles)
    text += "<triangle v1=\"" + std::to_string(a) + "\" v2=\"" + std::to_string(b) + "\" v3=\"" +
            std::to_string(c) + "\"/>";
  return text + "</triangles></mesh></object>";
}

/// An object made of others.
inline std::string three_mf_components(int number, const std::vector<int>& others) {
  std::string text = "<object id=\"" + std::to_string(number) + "\" type=\"model\"><components>";
  for (const int other : others) text += "<component objectid=\"" + std::to_string(other) + "\"/>";
  return text + "</components></object>";
}

/// An item of a build.
inline std::string three_mf_item(int object, const std::string& transform = "1 0 0 0 1 0 0 0 1 0 0 0") {
  return "<item objectid=\"" + std::to_string(object) + "\" transform=\"" + transform + "\"/>";
}

/// A 3MF file. `others` are further files in it, each with its relation to the package; those without content
/// are only named, and not there. `unit` may be followed by more attributes of the model.
inline std::string three_mf(const std::string& resources, const std::string& items,
                            const std::vector<std::pair<std::string, std::string>>& others = {},
                            bool deflated = false, const std::string& unit = "millimeter") {
  const std::string declaration = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  const std::string model =
      declaration + "<model unit=\"" + unit +
      "\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>" + resources +
      "</resources><build>" + items + "</build></model>";
  std::string relations =
      declaration +
      "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
      "Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
      "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>";
  for (std::size_t i = 0; i < others.size(); ++i)
    relations +=
        "<Relationship Target=\"/" + others[i].first + "\" Id=\"rel" + std::to_string(i + 1) +
        "\" Type=\"http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail\"/>";
  const std::string types =
      declaration +
      "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"><Default "
      "Extension=\"rels\" "
      "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Default "
      "Extension=\"model\" "
      "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/><Default Extension=\"png\" "
      "ContentType=\"image/png\"/></Types>";
  std::vector<std::pair<std::string, std::string>> entries = {{"[Content_Types].xml", types},
                                                              {"_rels/.rels", relations + "</Relationships>"},
                                                              {"3D/3dmodel.model", model}};
  for (const auto& other : others)
    if (!other.second.empty()) entries.push_back(other);
  return zip(entries, deflated);
}

}  // namespace fabseq::test
