// SPDX-License-Identifier: MIT
/// The keys of shapes, and checks that a declaration cannot express.
#include "fabseq/part/part_settings.h"

#include <algorithm>
#include <vector>

namespace fabseq {

namespace {

using Its = Shape;

bool all_zero(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return value == 0.0; });
}

Section<Shape> box_keys() {
  return Section<Its>("shape.box", "Box along the axes")
      .key("min", &Its::first, "Lower corner", {.required = true, .unit = "length"})
      .key("max", &Its::second, "Upper corner", {.required = true, .unit = "length"})
      .then([](Its& box, const Json& value, const KeyPlace& place) {
        for (std::size_t i = 0; i < box.first.size(); ++i)
          if (box.first[i] > box.second[i])
            refuse(pointer_to(pointer_to(place.pointer, "max"), i), shown(value.at("max")[i]),
                   "a number >= " + shown(value.at("min")[i]) + " (that entry of min)");
      });
}

Section<Shape> half_space_keys() {
  return Section<Its>("shape.half_space", "Half space")
      .key("point", &Its::first, "Point on the plane", {.required = true, .unit = "length"})
      .key("normal", &Its::second, "Outward normal, of any length", {.required = true})
      .then([](Its& half_space, const Json& value, const KeyPlace& place) {
        if (all_zero(half_space.second))
          refuse(pointer_to(place.pointer, "normal"), shown(value.at("normal")), "a vector other than 0");
      });
}

Section<Shape> cylinder_keys() {
  return Section<Its>("shape.cylinder", "Cylinder with flat ends")
      .key("from", &Its::first, "Centre of one end", {.required = true, .unit = "length"})
      .key("to", &Its::second, "Centre of the other end", {.required = true, .unit = "length"})
      .key("radius", &Its::radius, "Radius", {.required = true, .range = "(0, inf)", .unit = "length"})
      .then([](Its& cylinder, const Json& value, const KeyPlace& place) {
        if (cylinder.first == cylinder.second)
          refuse(pointer_to(place.pointer, "to"), shown(value.at("to")), "another point than from");
      });
}

Section<Shape> sphere_keys() {
  return Section<Its>("shape.sphere", "Sphere, in two dimensions a disc")
      .key("center", &Its::first, "Centre", {.required = true, .unit = "length"})
      .key("radius", &Its::radius, "Radius", {.required = true, .range = "(0, inf)", .unit = "length"});
}

Section<Shape> polygon_keys() {
  return Section<Its>("shape.polygon", "Polygon, in three dimensions extruded through the box")
      .key(
          "points", "Corners, in 3D in the two other axes in ascending order",
          {.type = KeyType::points, .required = true, .unit = "length"},
          [](Its& shape, const Json& value, const KeyPlace&) {
            shape.polygon = Polygon(value.get<std::vector<Polygon::Point>>());
          },
          [](Its& shape, Json& object) { object["points"] = shape.polygon.corners(); })
      .key("axis", &Its::axis, "Axis along which it is extruded",
           {.type = KeyType::axis, .required = true, .dimension = 3});
}

Section<Shape> shape_keys() {
  using Kind = Shape::Kind;
  Section<Its> result(
      "shape",
      "Shapes, for `part`, `substrate`, `clamps`, node sets and `start`: an object with exactly one of");
  // `dimension`: the only one in which the shape exists; 0: both.
  const auto primitive = [&](const char* name, Kind kind, int dimension, const char* meaning,
                             const Section<Shape>& keys) {
    result.declare(keys.declarations().front());
    result.key(
        name, meaning, {.type = KeyType::section, .dimension = dimension, .source = true},
        [kind, keys](Its& shape, const Json& value, const KeyPlace& place) {
          shape.kind = kind;
          keys.read(shape, value, place);
        },
        [name, kind, keys](Its& shape, Json& object) {
          if (shape.kind == kind) keys.write(shape, object[name] = Json::object());
        });
  };
  primitive("box", Kind::box, 0, "Box along the axes", box_keys());
  primitive("half_space", Kind::half_space, 0, "(x - point) · normal <= 0", half_space_keys());
  primitive("cylinder", Kind::cylinder, 3, "Cylinder with flat ends", cylinder_keys());
  primitive("sphere", Kind::sphere, 0, "Sphere or disc", sphere_keys());
  primitive("polygon", Kind::polygon, 0, "Polygon, even-odd rule", polygon_keys());
  const auto combination = [&](const char* name, Kind kind, const char* meaning) {
    result.key(
        name, meaning, {.type = KeyType::shapes, .source = true},
        [kind](Its& shape, const Json& value, const KeyPlace& place) {
          shape.kind = kind;
          for (std::size_t i = 0; i < value.size(); ++i)
            shape.operands.push_back(make_shape(value[i], {pointer_to(place.pointer, i), place.dimension}));
        },
        [name, kind](Its& shape, Json& object) {
          if (shape.kind != kind) return;
          Json& operands = object[name] = Json::array();
          for (const Shape& operand : shape.operands)
            write_shape(operand, operands.emplace_back(Json::object()));
        });
  };
  combination("union", Kind::union_of, "Points in at least one of the shapes");
  combination("intersection", Kind::intersection, "Points in all of the shapes");
  combination("difference", Kind::difference, "Points in the first of the shapes and in none of the others");
  return result;
}

const Section<Shape>& keys_of_shapes() {
  static const Section<Shape> keys = shape_keys();
  return keys;
}

}  // namespace

std::vector<SectionKeys> shape_declarations() { return keys_of_shapes().declarations(); }

Shape make_shape(const Json& value, const KeyPlace& place) {
  Shape shape;
  keys_of_shapes().read(shape, value, place);
  return shape;
}

void write_shape(const Shape& shape, Json& object) {
  if (make_shape(object, {"", 0}) == shape) return;
  const std::vector<SectionKeys> declared = keys_of_shapes().declarations();
  for (const ConfigKey& key : declared.front().keys) object.erase(key.name);
  Shape same = shape;
  keys_of_shapes().write(same, object);
}

}  // namespace fabseq
