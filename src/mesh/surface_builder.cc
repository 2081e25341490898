// SPDX-License-Identifier: MIT
#include "mesh/surface_builder.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace fabseq {

namespace {

constexpr std::int32_t none = -1;
constexpr auto most_triangles = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());

}  // namespace

SurfaceBuilder::SurfaceBuilder() : slots_(1 << 10, none) {}

void SurfaceBuilder::begin(std::vector<Point<3>> vertices) {
  vertices_ = std::move(vertices);
  numbers_.assign(vertices_.size(), none);
  polygons_ = 0;
}

void SurfaceBuilder::add_polygon(std::span<const std::int64_t> corners) {
  ++polygons_;
  for (const std::int64_t corner : corners)
    if (corner < 0 || corner >= static_cast<std::int64_t>(vertices_.size()))
      throw InputError("has a corner at vertex " + std::to_string(corner) + " in triangle or polygon " +
                       std::to_string(polygons_) + " of a surface, allowed are the numbers of its " +
                       std::to_string(vertices_.size()) + " vertices, from 0 on");
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const std::array<std::int32_t, 3> triangle = {
        number_of_vertex(corners[0]), number_of_vertex(corners[i - 1]), number_of_vertex(corners[i])};
    const auto& [p, q, r] = triangle;
    if (p != q && q != r && r != p) mesh_.triangles.push_back(triangle);
  }
  if (mesh_.triangles.size() > most_triangles)
    throw InputError("has more triangles than the " + std::to_string(most_triangles) + " that are allowed");
}

TriangleMesh SurfaceBuilder::take() {
  if (mesh_.triangles.empty())
    throw InputError("has no triangle, nor a polygon, with corners at different points; needs a surface");
  return std::move(mesh_);
}

std::int32_t SurfaceBuilder::number_of_vertex(std::int64_t vertex) {
  std::int32_t& number = numbers_[static_cast<std::size_t>(vertex)];
  if (number == none) {
    Point<3> point = vertices_[static_cast<std::size_t>(vertex)];
    for (double& coordinate : point) {
      if (!(std::abs(coordinate) <= largest_mesh_coordinate))
        throw InputError("has a point " + to_text<3>(point) +
                         formatted(", needs coordinates up to %g", largest_mesh_coordinate));
      coordinate += 0.0;  // -0.0 becomes 0.0
    }
    number = number_of_point(point);
  }
  return number;
}

std::int32_t SurfaceBuilder::number_of_point(const Point<3>& point) {
  if (2 * mesh_.points.size() >= slots_.size()) grow();
  std::int32_t& slot = slot_of(point);
  if (slot == none) {
    slot = static_cast<std::int32_t>(mesh_.points.size());
    mesh_.points.push_back(point);
  }
  return slot;
}

/// The slot with the point's number, or the free one where it belongs.
std::int32_t& SurfaceBuilder::slot_of(const Point<3>& point) {
  std::uint64_t hash = 0;
  for (const double coordinate : point) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(coordinate)) * 0x9e3779b97f4a7c15;
    hash ^= hash >> 32;
  }
  const std::size_t mask = slots_.size() - 1;  // the size is a power of two
  std::size_t slot = hash & mask;
  while (slots_[slot] != none && mesh_.points[slots_[slot]] != point) slot = (slot + 1) & mask;
  return slots_[slot];
}

void SurfaceBuilder::grow() {
  slots_.assign(2 * slots_.size(), none);
  for (std::size_t p = 0; p < mesh_.points.size(); ++p)
    slot_of(mesh_.points[p]) = static_cast<std::int32_t>(p);
}

}  // namespace fabseq
