// SPDX-License-Identifier: MIT
#include "mesh/three_mf_package.h"

#include "fabseq/base/error.h"
#include "mesh/text_values.h"
#include "mesh/xml_elements.h"
#include "mesh/zip_archive.h"

#include <charconv>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

namespace fabseq {

namespace {

constexpr std::string_view model_type = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";

struct Relation {
  std::string target, type, id;
};

/// Calls for_each_xml_element() for a file of the archive; errors name it.
template <class F>
void for_each_element(const ZipArchive& archive, const std::string& name, const F& f) {
  const std::string text = archive.read(name);
  try {
    for_each_xml_element(text, f);
  } catch (const InputError& error) {
    throw InputError(error.what() + std::string(" of \"") + name +
                     "\" in its archive, needs an intact 3MF file");
  }
}

std::string in_archive(std::string_view part) {
  return std::string(part.starts_with('/') ? part.substr(1) : part);
}

std::vector<Relation> relations_in(const ZipArchive& archive, const std::string& name) {
  std::vector<Relation> found;
  if (archive.has(name))
    for_each_element(archive, name, [&](std::string_view element, const XmlAttributes& attributes) {
      if (element == "Relationship")
        found.push_back({std::string(attributes["Target"]), std::string(attributes["Type"]),
                         std::string(attributes["Id"])});
    });
  return found;
}

/// The file with the build.
std::string root_model(const ZipArchive& archive) {
  for (const Relation& relation : relations_in(archive, "_rels/.rels"))
    if (relation.type == model_type) return in_archive(relation.target);
  return "3D/3dmodel.model";
}

/// What a model says, looked at element by element.
class Model {
 public:
  Model(const ZipArchive& archive, const std::string& name) {
    for_each_element(archive, name, [this](std::string_view element, const XmlAttributes& attributes) {
      if (element == "object")
        object_ = attributes["id"];
      else if (element == "mesh")
        vertices_ = triangles_ = 0;
      else if (element == "vertex")
        ++vertices_;
      else if (element == "triangle")
        check_triangle(attributes);
      else if (element == "item")
        printable_.push_back(attributes["printable"] != "0" && attributes["printable"] != "false");
      if (element == "item" || element == "component")
        if (const std::string_view path = attributes["path"]; !path.empty()) files_.insert(in_archive(path));
    });
  }

  const std::vector<bool>& printable() const { return printable_; }
  const std::set<std::string>& files() const { return files_; }

 private:
  void check_triangle(const XmlAttributes& attributes) {
    ++triangles_;
    for (const char* corner : {"v1", "v2", "v3"}) {
      const std::string_view text = attributes[corner];
      std::int64_t vertex = -1;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), vertex);
      if (error != std::errc() || end != text.data() + text.size() || vertex < 0 || vertex >= vertices_)
        throw InputError("has the corner \"" + std::string(text.substr(0, 40)) + "\" (allowed: 0 to " +
                         std::to_string(vertices_ - 1) + ") in triangle " + std::to_string(triangles_) +
                         " of object " + object_);
    }
  }

  std::string object_;
  std::int64_t vertices_ = 0, triangles_ = 0;  ///< of the object in hand
  std::vector<bool> printable_;
  std::set<std::string> files_;
};

std::string xml_quoted(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    if (letter == '&' || letter == '<' || letter == '"')
      result += letter == '&' ? "&amp;" : letter == '<' ? "&lt;" : "&quot;";
    else
      result += letter;
  }
  return '"' + result + '"';
}

std::string relations_text(const std::vector<Relation>& relations) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">";
  for (const Relation& relation : relations)
    text += "<Relationship Target=" + xml_quoted(relation.target) + " Id=" + xml_quoted(relation.id) +
            " Type=" + xml_quoted(relation.type) + "/>";
  return text + "</Relationships>";
}

/// The relations of a model with those that it lacks; none if it lacks none.
std::optional<std::vector<Relation>> completed(std::vector<Relation> relations,
                                               const std::set<std::string>& files) {
  std::set<std::string> known;
  for (const Relation& relation : relations) known.insert(in_archive(relation.target));
  const std::size_t before = relations.size();
  for (const std::string& file : files)
    if (!known.contains(file))
      relations.push_back({"/" + file, std::string(model_type), "added" + std::to_string(relations.size())});
  if (relations.size() == before) return std::nullopt;
  return relations;
}

}  // namespace

ThreeMfPackage prepare_three_mf(std::string bytes) {
  ZipArchive archive(std::move(bytes));
  const std::string root = root_model(archive);
  if (!archive.has(root)) throw InputError("is a ZIP archive without a model, needs an intact 3MF file");
  const Model model(archive, root);
  for (const std::string& file : model.files()) {
    if (!archive.has(file))
      throw InputError("names the file \"" + file +
                       "\", which is not in its archive, needs an intact 3MF file");
    (void)Model(archive, file);  // checks it
  }
  const std::size_t name = root.rfind('/') + 1;  // 0 where there is none
  const std::string relations = root.substr(0, name) + "_rels/" + root.substr(name) + ".rels";
  const auto wanted = completed(relations_in(archive, relations), model.files());
  ThreeMfPackage result;
  result.printable = model.printable();
  result.bytes = wanted ? archive.with_file(relations, relations_text(*wanted)) : std::move(archive).take();
  return result;
}

}  // namespace fabseq
