// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "fabseq/base/plain_numbers.h"
#include "mesh/mesh_formats.h"
#include "mesh/text_values.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace fabseq {

namespace {

/// The vertices and faces of an OBJ file; all else it may have counts nothing.
class ObjText {
 public:
  void read(std::string_view text) {
    for (std::size_t begin = 0; begin < text.size(); ++line_) {
      const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
      line_text_ += text.substr(begin, end - begin);
      begin = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
      const bool goes_on = line_text_.ends_with('\\') && !line_text_.starts_with('#');
      if (goes_on) {
        line_text_.back() = ' ';
        continue;
      }
      read_line();
      line_text_.clear();
    }
    read_line();
  }

  TriangleMesh take() {
    round_to_single(vertices_);
    const auto count = static_cast<std::int64_t>(vertices_.size());
    SurfaceBuilder surface;
    surface.begin(std::move(vertices_));
    std::vector<std::int64_t> polygon;
    auto corner = corners_.begin();
    for (const auto& [line, corners] : faces_) {
      polygon.assign(corner, corner + corners);
      corner += corners;
      for (const std::int64_t vertex : polygon)
        if (vertex < 0 || vertex >= count)
          throw InputError("has vertex " + std::to_string(vertex + 1) + " in a face in line " +
                           std::to_string(line) + ", allowed: 1 to " + std::to_string(count) +
                           ", its vertices, or as many back from -1 on");
      surface.add_polygon(polygon);
    }
    return surface.take();
  }

 private:
  struct Face {
    std::size_t line;
    std::ptrdiff_t corners;
  };

  void read_line() {
    line_text_.resize(std::min(line_text_.find('#'), line_text_.size()));
    TextWords words(line_text_);
    const std::string_view first = words.next();
    if (first == "v")
      read_vertex(words);
    else if (first == "f" || first == "fo")
      read_face(words);
  }

  /// Three coordinates; a fourth number divides them, and three more are a colour.
  void read_vertex(TextWords words) {
    try {
      Point<3> vertex = words.next_point();
      TextWords rest = words;
      const std::string_view fourth = rest.next();
      if (!fourth.empty() && rest.next().empty()) {
        const double weight = words.next_coordinate();
        if (weight != 0.0)
          for (double& coordinate : vertex) coordinate /= weight;
      }
      vertices_.push_back(vertex);
    } catch (const InputError&) {
      refuse_line();
    }
  }

  /// Corners are the numbers of a vertex, perhaps of a texture coordinate and of a normal: 7, 7/2, 7//3.
  void read_face(TextWords words) {
    std::ptrdiff_t count = 0;
    for (std::string_view word; !(word = words.next()).empty(); ++count) {
      const std::optional<std::int64_t> number =
          number_in<std::int64_t>(word.substr(0, std::min(word.find('/'), word.size())));
      if (!number) refuse_line();
      const auto vertices = static_cast<std::int64_t>(vertices_.size());
      corners_.push_back(*number < 0 ? vertices + std::max(*number, -vertices - 1) : *number - 1);
    }
    faces_.push_back({line_, count});
  }

  [[noreturn]] void refuse_line() const {
    throw InputError("has \"" + line_text_.substr(0, 60) + "\" in line " + std::to_string(line_) +
                     ", needs an intact OBJ file");
  }

  std::size_t line_ = 1;
  std::string line_text_;  ///< with the lines that it continues
  std::vector<Point<3>> vertices_;
  std::vector<std::int64_t> corners_;  ///< of all faces
  std::vector<Face> faces_;
};

}  // namespace

bool looks_like_obj(std::string_view file) {
  const std::string_view text = without_mark(file);
  for (const char* vertex : {"v ", "v\t"}) {
    const std::string word(vertex);
    if (text.starts_with(word) || text.find("\n" + word) != std::string_view::npos ||
        text.find("\r" + word) != std::string_view::npos)
      return true;
  }
  return false;
}

TriangleMesh read_obj(std::string_view file) {
  ObjText text;
  text.read(without_mark(file));
  return text.take();
}

}  // namespace fabseq
