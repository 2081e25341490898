// SPDX-License-Identifier: MIT
#include "fabseq/config/config_rules.h"
#include "fabseq/config/schema.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

bool all_zero(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return value == 0.0; });
}

void make_box(Shape& shape, const Json& value, const std::string& pointer) {
  shape.first = value.at("min").get<std::vector<double>>();
  shape.second = value.at("max").get<std::vector<double>>();
  for (std::size_t i = 0; i < shape.first.size(); ++i) {
    if (shape.first[i] <= shape.second[i]) continue;
    refuse(pointer_to(pointer_to(pointer, "max"), i), shown(value.at("max")[i]),
           "a number >= " + shown(value.at("min")[i]) + " (that entry of min)");
  }
}

void make_half_space(Shape& shape, const Json& value, const std::string& pointer) {
  shape.first = value.at("point").get<std::vector<double>>();
  shape.second = value.at("normal").get<std::vector<double>>();
  if (all_zero(shape.second))
    refuse(pointer_to(pointer, "normal"), shown(value.at("normal")), "a vector other than 0");
}

void make_cylinder(Shape& shape, const Json& value, const std::string& pointer) {
  shape.first = value.at("from").get<std::vector<double>>();
  shape.second = value.at("to").get<std::vector<double>>();
  shape.radius = value.at("radius").get<double>();
  if (shape.first == shape.second)
    refuse(pointer_to(pointer, "to"), shown(value.at("to")), "another point than from");
}

void make_sphere(Shape& shape, const Json& value, const std::string&) {
  shape.first = value.at("center").get<std::vector<double>>();
  shape.radius = value.at("radius").get<double>();
}

void make_polygon(Shape& shape, const Json& value, const std::string&) {
  for (const Json& point : value.at("points")) {
    shape.points.push_back({point[0].get<double>(), point[1].get<double>()});
  }
  if (const Json* axis = find_member(value, "axis")) shape.axis = axis->get<std::string>()[0] - 'x';
}

void make_operands(Shape& shape, const Json& value, const std::string& pointer) {
  for (std::size_t i = 0; i < value.size(); ++i) {
    shape.operands.push_back(make_shape(value[i], pointer_to(pointer, i)));
  }
}

struct Maker {
  const char* key;
  Shape::Kind kind;
  void (*make)(Shape& shape, const Json& value, const std::string& pointer);
};

constexpr Maker makers[] = {
    {"box", Shape::Kind::box, make_box},
    {"half_space", Shape::Kind::half_space, make_half_space},
    {"cylinder", Shape::Kind::cylinder, make_cylinder},
    {"sphere", Shape::Kind::sphere, make_sphere},
    {"polygon", Shape::Kind::polygon, make_polygon},
    {"union", Shape::Kind::union_of, make_operands},
    {"intersection", Shape::Kind::intersection, make_operands},
    {"difference", Shape::Kind::difference, make_operands},
};

}  // namespace

Shape make_shape(const Json& value, const std::string& pointer) {
  Shape shape;
  for (const Maker& maker : makers) {
    const Json* description = find_member(value, maker.key);
    if (description == nullptr) continue;
    shape.kind = maker.kind;
    maker.make(shape, *description, pointer_to(pointer, std::string(maker.key)));
  }
  return shape;
}

}  // namespace fabseq
