// SPDX-License-Identifier: MIT
#include "fabseq/config/config_keys.h"
#include "fabseq/config/named_files.h"
#include "fabseq/part/part_settings.h"

#include <cmath>

namespace fabseq {

namespace {

/// Edges that are longer than whole elements by this share of an element are not given another one.
constexpr double rounding = 1e-6;
constexpr double most_elements = 1e9;

/// A length per axis: the numbers of a key of the domain, one for all axes or one for each.
Point<3> lengths_of(const Json& domain, const std::string& name, bool may_be_zero) {
  Point<3> result{};
  const Json* found = find_member(domain, name);
  if (found == nullptr) return result;
  const auto is_length = [&](const Json& value) {
    return value.is_number() && std::isfinite(value.get<double>()) &&
           (value.get<double>() > 0.0 || (may_be_zero && value.get<double>() == 0.0));
  };
  const bool one_each = found->is_array() && found->size() == 3;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Json& value = one_each ? (*found)[axis] : *found;
    if (!is_length(value))
      refuse("/domain/" + name, shown(*found),
             std::string("a number ") + (may_be_zero ? ">= 0" : "> 0") + ", or a list of 3 such numbers");
    result[axis] = value.get<double>();
  }
  return result;
}

/// The box that holds the mesh and its margin in whole elements. On the plate it ends where the mesh does; on
/// the other axes what is left over is shared out to both ends.
void set_box(const PlacedMesh& mesh, const BuildPlate& plate, Json& domain) {
  const Point<3> element = lengths_of(domain, "element", false), margin = lengths_of(domain, "margin", true);
  Json size = Json::array(), origin = Json::array(), elements = Json::array();
  for (int axis = 0; axis < 3; ++axis) {
    const bool normal = axis == plate.axis;
    double low = mesh.lower()[axis] - (normal && !plate.upper ? 0.0 : margin[axis]);
    const double high = mesh.upper()[axis] + (normal && plate.upper ? 0.0 : margin[axis]);
    const double count = std::max(1.0, std::ceil((high - low) / element[axis] - rounding));
    if (count > most_elements)
      refuse("/domain/element", shown(domain.at("element")),
             "lengths that part the mesh, " + to_text<3>(mesh.lower()) + ".." + to_text<3>(mesh.upper()) +
                 ", into at most 1e9 elements an axis");
    const double left_over = count * element[axis] - (high - low);
    low -= !normal ? 0.5 * left_over : plate.upper ? left_over : 0.0;
    size.push_back(count * element[axis]);
    origin.push_back(low);
    elements.push_back(static_cast<std::int64_t>(count));
  }
  domain["size"] = size;
  domain["origin"] = origin;
  domain["elements"] = elements;
}

/// Completes the domain of a document whose part is a mesh.
void complete_domain(const PlacedMesh& mesh, const BuildPlate& plate, Json& document) {
  Json& domain = document["domain"];
  if (domain.is_null()) domain = Json::object();
  if (!domain.is_object() || find_member(domain, "element") == nullptr) return;
  for (const char* other : {"size", "origin", "elements"})
    if (const Json* found = find_member(domain, other))
      refuse("/domain/" + std::string(other), shown(*found), "this key or domain.element, not both");
  set_box(mesh, plate, domain);
  domain.erase("element");
  domain.erase("margin");
}

/// The plate of a document, the lower end of z where it names none; make_config() refuses other faces.
BuildPlate plate_of(const Json& document) {
  const Json* face = find_member(document, "build_plate");
  const bool named = face != nullptr && face->is_string() && face->get<std::string>().size() == 2 &&
                     std::string("xyz").find(face->get<std::string>()[0]) != std::string::npos;
  return make_plate(named ? face->get<std::string>() : "z-");
}

}  // namespace

std::shared_ptr<const PlacedMesh> place_mesh(MPI_Comm comm, Json& document, const std::string& directory) {
  const Json* mesh = find_member(document, "part", "mesh");
  if (mesh == nullptr) return nullptr;
  MeshFile description;
  const Json complete = complete_section(*mesh, "/part/mesh", "part.mesh", 3, directory);
  mesh_keys().read(description, complete, {"/part/mesh", 3});
  const BuildPlate plate = plate_of(document);
  auto placed = std::make_shared<const PlacedMesh>(comm, description, plate);
  complete_domain(*placed, plate, document);
  return placed;
}

}  // namespace fabseq
