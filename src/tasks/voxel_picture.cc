// SPDX-License-Identifier: MIT
#include "tasks/voxel_picture.h"

#include "fabseq/base/formatted.h"
#include "tasks/svg.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

constexpr double width = 900, height = 640, margin = 40, legend_width = 230;
/// The longest edge of the box, in pixels, so that every view fits.
constexpr double longest = 420;
/// Of the sides that are seen: the one towards x+, the one towards y-, the top.
constexpr std::array<double, 3> brightness = {0.72, 0.88, 1.0};
/// Axonometric view: x runs to the right and down a little, y to the right and up, z up.
constexpr std::array<std::array<double, 2>, 3> axes = {{{0.87, 0.32}, {0.62, -0.42}, {0.0, -0.92}}};

/// The corners of a face of a cell, in order.
std::array<Point<3>, 4> face(const Point<3>& low, const Point<3>& high, int axis, bool upper) {
  std::array<Point<3>, 4> corners;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (int i = 0; i < 4; ++i) {
    corners[i][axis] = upper ? high[axis] : low[axis];
    corners[i][u] = i == 1 || i == 2 ? high[u] : low[u];
    corners[i][v] = i >= 2 ? high[v] : low[v];
  }
  return corners;
}

}  // namespace

std::string hex(const VoxelPicture::Color& color, double brightness_) {
  std::array<int, 3> byte{};
  for (int i = 0; i < 3; ++i)
    byte[i] = static_cast<int>(std::lround(255.0 * std::clamp(color[i] * brightness_, 0.0, 1.0)));
  return formatted("#%02x%02x%02x", byte[0], byte[1], byte[2]);
}

VoxelPicture::VoxelPicture(const Index<3>& cells, const Point<3>& size, bool flat)
    : cells_(cells), flat_(flat) {
  const double scale = (flat ? 1.3 : 1.0) * longest / *std::max_element(size.begin(), size.end());
  for (int axis = 0; axis < 3; ++axis) edge_[axis] = size[axis] * scale / cells[axis];
}

std::array<double, 2> VoxelPicture::project(const Point<3>& point) const {
  if (flat_) return {margin + point[0] * edge_[0], height - margin - point[1] * edge_[1]};
  // The lowest place is that of the corner with x at its upper end, the others at their lower ends.
  std::array<double, 2> result = {margin, height - margin - axes[0][1] * cells_[0] * edge_[0]};
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 2; ++i) result[i] += axes[axis][i] * point[axis] * edge_[axis];
  return result;
}

void VoxelPicture::draw_quadrilateral(const std::array<Point<3>, 4>& corners, const std::string& color) {
  std::string points;
  for (const Point<3>& corner : corners) {
    const auto [x, y] = project(corner);
    points += svg::number(x) + "," + svg::number(y) + " ";
  }
  shapes_ += "<path d='M" + points + "z' fill='" + color + "' stroke='" + color + "'/>\n";
}

void VoxelPicture::draw_cells(const std::vector<int>& color_of, const std::vector<Color>& palette) {
  const IndexBox<3> box{{}, cells_};
  const auto is_empty = [&](const Index<3>& cell) {
    return !box.contains(cell) || color_of[box.offset(cell)] < 0;
  };
  // From the back to the front: y downwards, x and z upwards.
  for (int y = cells_[1] - 1; y >= 0; --y)
    for (int z = 0; z < cells_[2]; ++z)
      for (int x = 0; x < cells_[0]; ++x) {
        const Index<3> cell = {x, y, z};
        if (is_empty(cell)) continue;
        const Color& color = palette[color_of[box.offset(cell)]];
        const Point<3> low = {1.0 * x, 1.0 * y, 1.0 * z}, high = {x + 1.0, y + 1.0, z + 1.0};
        if (flat_) {
          draw_quadrilateral(face(low, high, 2, true), hex(color, 1.0));
          continue;
        }
        if (is_empty({x + 1, y, z})) draw_quadrilateral(face(low, high, 0, true), hex(color, brightness[0]));
        if (is_empty({x, y - 1, z})) draw_quadrilateral(face(low, high, 1, false), hex(color, brightness[1]));
        if (is_empty({x, y, z + 1})) draw_quadrilateral(face(low, high, 2, true), hex(color, brightness[2]));
      }
}

void VoxelPicture::draw_side(int axis, bool upper, const std::string& color) {
  draw_quadrilateral(face({}, {1.0 * cells_[0], 1.0 * cells_[1], 1.0 * cells_[2]}, axis, upper), color);
}

void VoxelPicture::draw_points(const std::vector<Point<3>>& points, const std::string& color) {
  shapes_ += "<g fill='" + color + "'>\n";
  for (const Point<3>& point : points) {
    const auto [x, y] = project(point);
    shapes_ += "<circle cx='" + svg::number(x) + "' cy='" + svg::number(y) + "' r='2'/>\n";
  }
  shapes_ += "</g>\n";
}

void VoxelPicture::add_legend(const std::string& color, const std::string& text) {
  const double x = width - legend_width, y = 80.0 + 22.0 * legend_lines_++;
  legend_ += "<rect x='" + svg::number(x) + "' y='" + svg::number(y - 11) +
             "' width='14' height='14' fill='" + color + "'/><text x='" + svg::number(x + 22) + "' y='" +
             svg::number(y) + "'>" + svg::escaped(text) + "</text>\n";
}

std::string VoxelPicture::svg(const std::string& title) const {
  return svg::begin(width, height) + "<text x='40' y='34' font-size='16'>" + svg::escaped(title) +
         "</text>\n<g stroke-width='0.4' stroke-linejoin='round'>\n" + shapes_ + "</g>\n" + legend_ +
         "</svg>\n";
}

}  // namespace fabseq
