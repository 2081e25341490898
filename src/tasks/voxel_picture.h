// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"

#include <array>
#include <string>
#include <vector>

namespace fabseq {

/// A view of cubes from the front, the right and above, as an SVG picture: of any number of cells, each with
/// a colour and hidden by those before it. In two dimensions z has one cell.
class VoxelPicture {
 public:
  using Color = std::array<double, 3>;  ///< red, green, blue, 0 to 1

  /// `cells`: number of cells along each axis; `size`: of the whole box, for the proportions; `flat`: seen
  /// from the front, as two-dimensional parts are.
  VoxelPicture(const Index<3>& cells, const Point<3>& size, bool flat);

  /// Draws the faces of all cells that `color_of` has a colour for (an index into `palette`, -1 for none),
  /// lexicographic, x fastest.
  void draw_cells(const std::vector<int>& color_of, const std::vector<Color>& palette);
  /// Draws the rectangle of the box's side at the end of an axis.
  void draw_side(int axis, bool upper, const std::string& color);
  /// Marks points of the box, in cells.
  void draw_points(const std::vector<Point<3>>& points, const std::string& color);
  /// A line of text beside a square of that colour, below the lines before.
  void add_legend(const std::string& color, const std::string& text);

  /// The picture, with a title above.
  std::string svg(const std::string& title) const;

 private:
  /// Place of a point of the box, given in cells, on the picture.
  std::array<double, 2> project(const Point<3>& point) const;
  void draw_quadrilateral(const std::array<Point<3>, 4>& corners, const std::string& color);

  Index<3> cells_;
  Point<3> edge_{};  ///< of a cell, in pixels of the picture
  bool flat_;
  std::string shapes_, legend_;
  int legend_lines_ = 0;
};

/// "#rrggbb"
std::string hex(const VoxelPicture::Color& color, double brightness);

}  // namespace fabseq
