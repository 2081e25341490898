// SPDX-License-Identifier: MIT
#include "mesh/three_mf_package.h"

#include "fabseq/base/error.h"
#include "mesh/archived_xml.h"
#include "mesh/text_values.h"
#include "mesh/zip_archive.h"

#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

constexpr std::string_view model_type = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";

constexpr const char* of_package = "_rels/.rels";

struct Relation {
  std::string target, type, id;

  bool operator==(const Relation&) const = default;
};

std::vector<Relation> relations_in(const ZipArchive& archive, const std::string& name) {
  std::vector<Relation> found;
  if (archive.has(name))
    for_each_archived_element(archive, name, [&](std::string_view element, const XmlAttributes& attributes) {
      if (element == "Relationship")
        found.push_back({std::string(attributes["Target"]), std::string(attributes["Type"]),
                         std::string(attributes["Id"])});
    });
  return found;
}

/// The file with the build.
std::string root_model(const ZipArchive& archive) {
  for (const Relation& relation : relations_in(archive, of_package))
    if (relation.type == model_type) return in_archive(relation.target);
  return "3D/3dmodel.model";
}

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

/// What an archive is that is no 3MF file.
std::string archive_without_model(const ZipArchive& archive) {
  if (archive.has("Document.xml"))
    return "a FreeCAD file, which has no triangles: export STL or 3MF from the CAD program";
  for (const std::string& name : archive.names())
    for (const char* ending : {".stl", ".obj", ".ply", ".3mf", ".amf"})
      if (lower_case(name).ends_with(ending))
        return "a ZIP archive with \"" + name +
               "\" in it: unpack it first, needs an STL, OBJ, PLY or 3MF file";
  return "a ZIP archive without a model, needs an intact 3MF file";
}

/// Leaves out relations to what is not there, such as the picture that a slicer's command line names and does
/// not make. Those to models stay.
std::vector<Relation> without_missing(const std::vector<Relation>& relations, const ZipArchive& archive) {
  std::vector<Relation> result;
  for (const Relation& relation : relations)
    if (relation.type == model_type || archive.has(in_archive(relation.target))) result.push_back(relation);
  return result;
}

/// The relations of a model with those that it lacks.
std::vector<Relation> completed(std::vector<Relation> relations, const std::set<std::string>& files) {
  std::set<std::string> known;
  for (const Relation& relation : relations) known.insert(in_archive(relation.target));
  for (const std::string& file : files)
    if (!known.contains(file))
      relations.push_back({"/" + file, std::string(model_type), "added" + std::to_string(relations.size())});
  return relations;
}

/// The archive as lib3mf reads it.
std::string repaired(ZipArchive&& archive, const std::string& root, const std::set<std::string>& models) {
  const std::size_t name = root.rfind('/') + 1;  // 0 where there is none
  const std::string of_model = root.substr(0, name) + "_rels/" + root.substr(name) + ".rels";
  std::map<std::string, std::string> changed;
  const auto change = [&](const std::string& file, const std::set<std::string>& needed) {
    const std::vector<Relation> found = relations_in(archive, file);
    const std::vector<Relation> wanted = completed(without_missing(found, archive), needed);
    if (wanted != found) changed[file] = relations_text(wanted);
  };
  change(of_package, {});
  change(of_model, models);
  return changed.empty() ? std::move(archive).take() : archive.with_files(changed);
}

}  // namespace

ThreeMfPackage prepare_three_mf(std::string bytes) {
  ZipArchive archive(std::move(bytes));
  const std::string root = root_model(archive);
  if (!archive.has(root)) throw InputError("is " + archive_without_model(archive));
  ThreeMfPackage result;
  result.contents = read_three_mf_contents(archive, root);
  result.root = root;
  result.volumes = read_slicer_volumes(archive);
  result.bytes = repaired(std::move(archive), root, result.contents.other_files);
  return result;
}

}  // namespace fabseq
