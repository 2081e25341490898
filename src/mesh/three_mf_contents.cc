// SPDX-License-Identifier: MIT
#include "mesh/three_mf_contents.h"

#include "fabseq/base/error.h"
#include "fabseq/base/plain_numbers.h"
#include "mesh/archived_xml.h"
#include "mesh/zip_archive.h"

#include <algorithm>
#include <string_view>

namespace fabseq {

namespace {

/// Extensions without which a mesh is the same, as they stand in the addresses of their namespaces.
constexpr std::string_view harmless[] = {"production", "material", "slice"};
/// Elements of extensions that are shapes in place of a mesh.
constexpr std::string_view shapes[] = {"booleanshape", "levelset", "displacementmesh"};

/// "beamlattice" of http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02; the address itself if
/// it has another form.
std::string name_of_extension(std::string_view address) {
  constexpr std::string_view folder = "/3dmanufacturing/";
  const std::size_t found = address.find(folder);
  if (found == std::string_view::npos) return std::string(address);
  const std::string_view name = address.substr(found + folder.size());
  return std::string(name.substr(0, name.find('/')));
}

/// Takes the elements of one model one after the other.
class Model {
 public:
  Model(std::string file, bool is_root, ThreeMfContents& contents)
      : file_(std::move(file)), is_root_(is_root), contents_(contents) {}

  void take(std::string_view element, const XmlAttributes& attributes) {
    if (element == "model") {
      refuse_extensions(attributes);
    } else if (element == "object") {
      begin_object(attributes);
    } else if (element == "mesh") {
      vertices_ = triangles_ = 0;
    } else if (element == "vertex") {
      ++vertices_;
    } else if (element == "triangle") {
      check_triangle(attributes);
    } else if (element == "component") {
      if (object_ != nullptr) object_->components.push_back(name_in(attributes));
    } else if (element == "item" && is_root_) {
      const std::string_view printable = attributes["printable"];
      contents_.items.push_back({name_in(attributes), printable != "0" && printable != "false"});
    } else if (element == "beamlattice") {
      ++contents_.lattices;
    } else if (std::find(std::begin(shapes), std::end(shapes), element) != std::end(shapes)) {
      throw NotReadError("has a \"" + std::string(element) + "\" as object " + number_ +
                         ", which is not read; needs meshes of triangles");
    }
  }

 private:
  void refuse_extensions(const XmlAttributes& attributes) const {
    std::string_view required = attributes["requiredextensions"];
    while (!required.empty()) {
      const std::size_t end = std::min(required.find_first_of(" \t\r\n"), required.size());
      const std::string prefix(required.substr(0, end));
      required.remove_prefix(std::min(end + 1, required.size()));
      if (prefix.empty()) continue;
      const std::string_view address = attributes.exactly("xmlns:" + prefix);
      const std::string name = name_of_extension(address.empty() ? prefix : address);
      if (std::find(std::begin(harmless), std::end(harmless), name) == std::end(harmless))
        throw NotReadError("requires the extension \"" + name +
                           "\" of 3MF, which is not read; needs meshes of triangles, with no other extension "
                           "than production, material and slice");
    }
  }

  void begin_object(const XmlAttributes& attributes) {
    number_ = attributes["id"];
    object_ = &contents_.objects[{file_, number_}];
    if (const std::string_view type = attributes["type"]; !type.empty()) object_->type = type;
    if (attributes["meshresolution"] == "lowres")
      throw NotReadError(
          "has object " + number_ +
          " as slices, which are not read, beside a rough mesh; needs a mesh of full resolution");
  }

  void check_triangle(const XmlAttributes& attributes) {
    ++triangles_;
    for (const char* corner : {"v1", "v2", "v3"}) {
      const std::string_view text = attributes[corner];
      const auto vertex = number_in<std::int64_t>(text);
      if (!vertex || *vertex < 0 || *vertex >= vertices_)
        throw InputError("has the corner \"" + std::string(text.substr(0, 40)) + "\" (allowed: 0 to " +
                         std::to_string(vertices_ - 1) + ") in triangle " + std::to_string(triangles_) +
                         " of object " + number_);
    }
  }

  /// The object that an item or a component names.
  ThreeMfName name_in(const XmlAttributes& attributes) {
    const std::string_view path = attributes["path"];
    if (!path.empty()) contents_.other_files.insert(in_archive(path));
    return {path.empty() ? file_ : in_archive(path), std::string(attributes["objectid"])};
  }

  std::string file_;
  bool is_root_;
  ThreeMfContents& contents_;
  ThreeMfContents::Object* object_ = nullptr;  ///< in hand
  std::string number_;                         ///< its number
  std::int64_t vertices_ = 0, triangles_ = 0;  ///< of the mesh in hand
};

void read_model(const ZipArchive& archive, const std::string& file, bool is_root, ThreeMfContents& contents) {
  Model model(file, is_root, contents);
  const auto take = [&](std::string_view element, const XmlAttributes& attributes) {
    model.take(element, attributes);
  };
  for_each_archived_element(archive, file, take);
}

}  // namespace

std::string in_archive(std::string_view part) {
  return std::string(part.starts_with('/') ? part.substr(1) : part);
}

ThreeMfContents read_three_mf_contents(const ZipArchive& archive, const std::string& root) {
  ThreeMfContents contents;
  read_model(archive, root, true, contents);
  const std::set<std::string> named = contents.other_files;
  for (const std::string& file : named) {
    if (file == root) continue;
    if (!archive.has(file))
      throw InputError("names the file \"" + file +
                       "\", which is not in its archive, needs an intact 3MF file");
    read_model(archive, file, false, contents);
  }
  return contents;
}

}  // namespace fabseq
