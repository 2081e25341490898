// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "fabseq/base/plain_numbers.h"
#include "mesh/mesh_formats.h"
#include "mesh/ply_values.h"

#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

namespace fabseq {

namespace {

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float64;
  std::optional<PlyType> count;  ///< type of the number of entries, of a list
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyForm form = PlyForm::text;
  std::vector<PlyElement> elements;
  std::size_t end = 0;  ///< where the data begin
};

[[noreturn]] void refuse_header(const std::string& line) {
  throw InputError("has the line \"" + line.substr(0, 60) + "\" in its header, needs an intact PLY file");
}

PlyType type_of(const std::string& name, const std::string& line) {
  const std::optional<PlyType> type = ply_type(name);
  if (!type) refuse_header(line);
  return *type;
}

/// Reads the words of a line of the header; false for the line that ends it.
bool read_line(const std::string& line, PlyHeader& header) {
  std::istringstream stream(line);
  const std::vector<std::string> words{std::istream_iterator<std::string>(stream), {}};
  const auto word = [&](std::size_t i) { return i < words.size() ? words[i] : std::string(); };
  const std::string first = word(0);
  if (first == "end_header") return false;
  if (first == "format") {
    const std::optional<PlyForm> form = ply_form(word(1));
    if (!form) refuse_header(line);
    header.form = *form;
  } else if (first == "element") {
    PlyElement& element = header.elements.emplace_back();
    element.name = word(1);
    const std::optional<std::int64_t> count = number_in<std::int64_t>(word(2));
    if (!count || *count < 0) refuse_header(line);
    element.count = *count;
  } else if (first == "property") {
    if (header.elements.empty()) refuse_header(line);
    const bool is_list = word(1) == "list";
    PlyProperty property;
    if (is_list) property.count = type_of(word(2), line);
    property.type = type_of(word(is_list ? 3 : 1), line);
    property.name = word(is_list ? 4 : 2);
    header.elements.back().properties.push_back(property);
  }
  return true;  // comments and what else there may be count nothing
}

/// The line ends of the first line are those of the whole header: binary data may begin with any byte.
PlyHeader read_header(std::string_view file) {
  const std::string_view line_end = file.starts_with("ply\r\n") ? "\r\n" : file.substr(3, 1);
  PlyHeader header;
  std::size_t begin = 3 + line_end.size();
  while (true) {
    const std::size_t end = file.find(line_end, begin);
    // A file of text may end right behind its header.
    const std::string line(file.substr(begin, end == std::string_view::npos ? end : end - begin));
    const bool last = end == std::string_view::npos;
    header.end = last ? file.size() : end + line_end.size();
    if (!read_line(line, header)) return header;
    if (last) throw InputError("ends before its header does, needs an intact PLY file");
    begin = header.end;
  }
}

/// A property's value in one row of an element: of a scalar one entry, of a list any number.
using PlyRow = std::vector<std::vector<double>>;

void read_row(const PlyElement& element, PlyValues& values, PlyRow& row) {
  row.resize(element.properties.size());
  for (std::size_t p = 0; p < row.size(); ++p) {
    const PlyProperty& property = element.properties[p];
    const std::size_t count = property.count ? values.next_count(*property.count) : 1;
    row[p].resize(count);
    for (double& value : row[p]) value = values.next(property.type);
  }
}

/// Which property has one of the names; throws InputError if none has.
std::size_t position_of(const PlyElement& element, std::initializer_list<const char*> names) {
  for (const char* name : names)
    for (std::size_t p = 0; p < element.properties.size(); ++p)
      if (element.properties[p].name == name) return p;
  throw InputError("has no property " + std::string(*names.begin()) + " of element " + element.name +
                   ", needs an intact PLY file");
}

std::vector<Point<3>> read_vertices(const PlyElement& element, PlyValues& values) {
  const std::array<std::size_t, 3> axes = {position_of(element, {"x"}), position_of(element, {"y"}),
                                           position_of(element, {"z"})};
  std::vector<Point<3>> vertices;
  PlyRow row;
  for (std::int64_t v = 0; v < element.count; ++v) {
    read_row(element, values, row);
    Point<3>& vertex = vertices.emplace_back();
    for (int axis = 0; axis < 3; ++axis)
      if (!row[axes[axis]].empty()) vertex[axis] = row[axes[axis]][0];
  }
  return vertices;
}

/// The number of a vertex; -1 for what is none.
std::int64_t vertex_of(double value) {
  constexpr double largest = 4294967295.0;
  return value >= 0.0 && value <= largest ? static_cast<std::int64_t>(value) : -1;
}

/// A strip's triangles share edges with the one before, by turns in the other sense; -1 begins a new strip.
void add_strips(const std::vector<double>& corners, SurfaceBuilder& surface) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] < 0) {
      begin = i + 1;
    } else if (i >= begin + 2) {
      const std::size_t turned = (i - begin) % 2;
      surface.add_polygon(std::array{vertex_of(corners[i - 2 + turned]), vertex_of(corners[i - 1 - turned]),
                                     vertex_of(corners[i])});
    }
  }
}

void add_faces(const PlyElement& element, PlyValues& values, SurfaceBuilder& surface) {
  const std::size_t corners = position_of(element, {"vertex_indices", "vertex_index"});
  PlyRow row;
  std::vector<std::int64_t> polygon;
  for (std::int64_t f = 0; f < element.count; ++f) {
    read_row(element, values, row);
    if (element.name == "tristrips") {
      add_strips(row[corners], surface);
      continue;
    }
    polygon.clear();
    for (const double corner : row[corners]) polygon.push_back(vertex_of(corner));
    surface.add_polygon(polygon);
  }
}

}  // namespace

TriangleMesh read_ply(std::string_view file) {
  const PlyHeader header = read_header(file);
  PlyValues values(file.substr(header.end), header.form);
  SurfaceBuilder surface;
  bool has_vertices = false;
  for (const PlyElement& element : header.elements) {
    const bool faces = element.name == "face" || element.name == "tristrips";
    if (faces && !has_vertices && element.count > 0)
      throw InputError("has faces before vertices, needs vertices first");
    if (element.name == "vertex") {
      surface.begin(read_vertices(element, values));
      has_vertices = true;
    } else if (faces) {
      add_faces(element, values, surface);
    } else {
      PlyRow row;
      for (std::int64_t i = 0; i < element.count && !element.properties.empty(); ++i)
        read_row(element, values, row);
    }
  }
  return surface.take();
}

}  // namespace fabseq
