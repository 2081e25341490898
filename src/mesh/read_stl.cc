// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "mesh/mesh_formats.h"
#include "mesh/text_values.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

namespace fabseq {

namespace {

constexpr std::size_t bytes_of_header = 84, bytes_of_triangle = 50;

void add_all(std::vector<Point<3>> corners, const std::vector<std::int64_t>& ends, SurfaceBuilder& surface) {
  surface.begin(std::move(corners));
  std::vector<std::int64_t> polygon;
  std::int64_t corner = 0;
  for (const std::int64_t end : ends) {
    polygon.clear();
    for (; corner < end; ++corner) polygon.push_back(corner);
    surface.add_polygon(polygon);
  }
}

/// A number of a binary file, which has the lowest byte first.
std::uint32_t number_at(std::string_view file, std::size_t place) {
  std::uint32_t value = 0;
  for (int byte = 3; byte >= 0; --byte)
    value = value << 8 | static_cast<unsigned char>(file[place + static_cast<std::size_t>(byte)]);
  return value;
}

TriangleMesh binary_triangles(std::string_view file, std::size_t count) {
  std::vector<Point<3>> corners(3 * count);
  std::vector<std::int64_t> ends(count);
  for (std::size_t t = 0; t < count; ++t) {
    const std::size_t first = bytes_of_header + t * bytes_of_triangle + 12;  // behind the normal
    for (std::size_t i = 0; i < 9; ++i)
      corners[3 * t + i / 3][i % 3] = std::bit_cast<float>(number_at(file, first + 4 * i));
    ends[t] = static_cast<std::int64_t>(3 * t + 3);
  }
  SurfaceBuilder surface;
  add_all(std::move(corners), ends, surface);
  return surface.take();
}

/// The count of a file may be wrong: then all triangles that there is room for are read if they are a closed
/// surface.
TriangleMesh read_binary(std::string_view file, std::vector<std::string>& notes) {
  const std::size_t stated = number_at(file, 80), room = (file.size() - bytes_of_header) / bytes_of_triangle;
  const std::size_t left_over = (file.size() - bytes_of_header) % bytes_of_triangle;
  const std::string says = "says that it has " + std::to_string(stated) + " triangles, ";
  if (stated == room && left_over == 0) return binary_triangles(file, room);
  if (stated != room && left_over == 0 && room > 0) {
    TriangleMesh all = binary_triangles(file, room);
    if (is_closed(all)) {
      notes.push_back(says + "but has " + std::to_string(room) + ", a closed surface: all are read");
      return all;
    }
  }
  if (stated > room)
    throw InputError(says + "but has bytes for " + std::to_string(room) +
                     ": it is cut off; needs an intact STL, OBJ, PLY or 3MF file");
  notes.push_back(std::to_string(file.size() - bytes_of_header - stated * bytes_of_triangle) +
                  " bytes behind the last triangle are left out");
  return binary_triangles(file, stated);
}

/// The words of a text file; what they mean for the triangle in hand.
class StlText {
 public:
  explicit StlText(std::string_view text) : words_(text) {}

  TriangleMesh read(std::vector<std::string>& notes) {
    std::string word;
    std::string last;
    while (!(word = lower_case(words_.next())).empty()) {
      take(word);
      last = word;
    }
    if (in_facet_) refuse("ends within a facet");
    if (last != "endsolid") notes.emplace_back("has no \"endsolid\" at its end: it may be cut off");
    round_to_single(corners_);
    SurfaceBuilder surface;
    add_all(std::move(corners_), ends_, surface);
    return surface.take();
  }

 private:
  void take(const std::string& word) {
    if (word == "vertex") {
      if (!in_facet_) refuse("has a vertex outside a facet");
      corners_.push_back(words_.next_point());
    } else if (word == "facet") {
      if (in_facet_) refuse("has a facet within a facet");
      in_facet_ = true;
    } else if (word == "normal") {
      for (int i = 0; i < 3; ++i) (void)words_.next();  // whatever they are
    } else if (word == "endfacet") {
      end_facet();
    } else if (word == "solid" || word == "endsolid") {
      words_.skip_line();  // a name
    } else if (word != "outer" && word != "loop" && word != "endloop") {
      refuse("has \"" + word.substr(0, 40) + "\"");
    }
  }

  void end_facet() {
    const auto end = static_cast<std::int64_t>(corners_.size());
    if (!in_facet_ || end - (ends_.empty() ? 0 : ends_.back()) < 3)
      refuse("has a facet with fewer than 3 corners");
    ends_.push_back(end);
    in_facet_ = false;
  }

  [[noreturn]] void refuse(const std::string& found) const {
    throw InputError(found + " in line " + std::to_string(words_.line()) +
                     ", needs an intact STL, OBJ, PLY or 3MF file");
  }

  TextWords words_;
  std::vector<Point<3>> corners_;
  std::vector<std::int64_t> ends_;  ///< of each facet in corners_
  bool in_facet_ = false;
};

bool is_text(std::string_view file) { return file.substr(0, 512).find('\0') == std::string_view::npos; }

}  // namespace

bool looks_like_stl(std::string_view file, bool by_name) {
  if (file.size() >= bytes_of_header &&
      (file.size() - bytes_of_header) == std::uint64_t{bytes_of_triangle} * number_at(file, 80))
    return true;
  TextWords words(without_mark(file));
  if (is_text(file)) return lower_case(words.next()) == "solid";
  return by_name && file.size() >= bytes_of_header;
}

TriangleMesh read_stl(std::string_view file, std::vector<std::string>& notes) {
  const bool exact =
      file.size() >= bytes_of_header &&
      (file.size() - bytes_of_header) == std::uint64_t{bytes_of_triangle} * number_at(file, 80);
  if (exact || !is_text(file)) return read_binary(file, notes);
  return StlText(without_mark(file)).read(notes);
}

}  // namespace fabseq
