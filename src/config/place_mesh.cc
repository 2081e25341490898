// SPDX-License-Identifier: MIT
#include "config/config_keys.h"
#include "config/named_files.h"
#include "fabseq/base/error.h"
#include "fabseq/part/part_settings.h"

#include <cmath>
#include <optional>

namespace fabseq {

namespace {

/// Edges that are longer than whole elements by this share of an element are not given another one.
constexpr double rounding = 1e-6;
constexpr double most_elements = 1e9;  // along an axis, and of boxes that are tried

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

/// The box that holds the mesh and its margin in whole elements, `more` of them beyond as few as possible. On
/// the plate it ends where the mesh does; on the other axes what is left over is shared out to both ends.
Domain<3> box_around(const PlacedMesh& mesh, const BuildPlate& plate, const Point<3>& element,
                     const Point<3>& margin, const Index<3>& more) {
  Domain<3> box;
  for (int axis = 0; axis < 3; ++axis) {
    const bool normal = axis == plate.axis;
    double low = mesh.lower()[axis] - (normal && !plate.upper ? 0.0 : margin[axis]);
    const double high = mesh.upper()[axis] + (normal && plate.upper ? 0.0 : margin[axis]);
    const double count = std::max(1.0, std::ceil((high - low) / element[axis] - rounding)) + more[axis];
    if (count > most_elements)
      refuse("/domain/element", to_text<3>(element),
             "lengths that part the mesh, " + to_text<3>(mesh.lower()) + ".." + to_text<3>(mesh.upper()) +
                 ", into at most 1e9 elements an axis");
    const double left_over = count * element[axis] - (high - low);
    low -= !normal ? 0.5 * left_over : plate.upper ? left_over : 0.0;
    box.size[axis] = count * element[axis];
    box.origin[axis] = low;
    box.elements[axis] = static_cast<int>(count);
  }
  return box;
}

/// Chooses, of the boxes with as few elements as possible along each axis across the plate's normal and with
/// one more, the one whose elements have nearest to the mesh's volume. In the smallest box, the outer
/// elements are always half full at least, so would always be built. Where it ends at the mesh, it stays.
Domain<3> box_of_nearest_volume(MPI_Comm comm, const PlacedMesh& mesh, const MeshFile& description,
                                const BuildPlate& plate, const Point<3>& element, const Point<3>& margin) {
  constexpr double better = 1e-6;  // by this share of the volume at least
  const Domain<3> smallest = box_around(mesh, plate, element, margin, {});
  const double count =
      static_cast<double>(smallest.elements[0]) * smallest.elements[1] * smallest.elements[2];
  if (!description.fill || count > most_elements) return smallest;
  const auto most_more = [&](int axis) {
    const double elements = (mesh.lower()[axis] - smallest.origin[axis]) / element[axis];
    return axis == plate.axis || std::abs(elements - std::round(elements)) < rounding ? 0 : 1;
  };
  const double volume_of_element = element[0] * element[1] * element[2];
  const IndexBox<3> choices{{0, 0, 0}, {1 + most_more(0), 1 + most_more(1), 1 + most_more(2)}};
  Domain<3> best = smallest;
  double least = HUGE_VAL;
  choices.for_each([&](const Index<3>& more, std::int64_t) {
    const Domain<3> box = box_around(mesh, plate, element, margin, more);
    const double volume =
        volume_of_element * static_cast<double>(mesh.count_filled(comm, box, *description.fill));
    const double error = std::abs(volume / mesh.volume() - 1.0);
    if (error >= least - better) return;
    least = error;
    best = box;
  });
  return best;
}

/// Completes the domain of a document whose part is a mesh. Collective.
void complete_domain(MPI_Comm comm, const PlacedMesh& mesh, const MeshFile& description,
                     const BuildPlate& plate, Json& document) {
  Json& domain = document["domain"];
  if (domain.is_null()) domain = Json::object();
  if (!domain.is_object() || find_member(domain, "element") == nullptr) return;
  for (const char* other : {"size", "origin", "elements"})
    if (const Json* found = find_member(domain, other))
      refuse("/domain/" + std::string(other), shown(*found), "this key or domain.element, not both");
  const Domain<3> box =
      box_of_nearest_volume(comm, mesh, description, plate, lengths_of(domain, "element", false),
                            lengths_of(domain, "margin", true));
  domain["size"] = box.size;
  domain["origin"] = box.origin;
  domain["elements"] = box.elements;
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

/// The mesh that is the part of a document, and where it is to stand.
struct MeshOfConfig {
  MeshFile description;
  BuildPlate plate;
  std::string unit;
};

std::optional<MeshOfConfig> mesh_of(const Json& document, const std::string& directory) {
  const Json* mesh = find_member(document, "part", "mesh");
  if (mesh == nullptr) return std::nullopt;
  MeshOfConfig result;
  const Json complete = complete_section(*mesh, "/part/mesh", "part.mesh", 3, directory);
  mesh_keys().read(result.description, complete, {"/part/mesh", 3});
  result.plate = plate_of(document);
  const Json* unit = find_member(document, "domain", "unit");
  if (unit != nullptr && unit->is_string()) result.unit = unit->get<std::string>();
  return result;
}

}  // namespace

std::shared_ptr<const PlacedMesh> place_mesh(MPI_Comm comm, Json& document, const std::string& directory) {
  const auto mesh = mesh_of(document, directory);
  if (!mesh) return nullptr;
  auto placed = std::make_shared<const PlacedMesh>(comm, mesh->description, mesh->plate, mesh->unit);
  complete_domain(comm, *placed, mesh->description, mesh->plate, document);
  return placed;
}

PlacedSurface surface_of_config(MPI_Comm comm, const Json& document, const std::string& directory) {
  const auto mesh = mesh_of(document, directory);
  if (!mesh)
    throw InputError("/part/mesh: missing; allowed with -task surface: a part that comes from a mesh file");
  return read_placed_surface(comm, mesh->description, mesh->plate, mesh->unit);
}

}  // namespace fabseq
