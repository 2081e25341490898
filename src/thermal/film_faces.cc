// SPDX-License-Identifier: MIT
#include "fabseq/thermal/film_faces.h"

namespace fabseq {

template <int Dim>
FilmFaces<Dim>::FilmFaces(const Part<Dim>& part, std::span<const int> elements,
                          std::span<const int> first_corners)
    : part_(part), halo_(part.grid(), 1), first_corners_(first_corners.begin(), first_corners.end()) {
  const Grid<Dim>& grid = part.grid();
  for (int direction = 0; direction < 2 * Dim; ++direction) {
    auto next = corners_[direction].begin();
    for (int corner = 0; corner < corner_count<Dim>; ++corner)
      if ((corner >> direction / 2 & 1) == direction % 2) *next++ = grid.corner_offsets()[corner];
  }
  const std::vector<double> solid = halo_.gather(part.solid());
  const int plate_side = 2 * part.plate().axis + (part.plate().upper ? 1 : 0);
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const Index<Dim> element = grid.owned_elements().index(elements[i]);
    for (int direction = 0; direction < 2 * Dim; ++direction) {
      Index<Dim> beside = element;
      beside[direction / 2] += direction % 2 == 0 ? -1 : 1;
      const bool inside = grid.all_elements().contains(beside);
      if (!inside && direction == plate_side) continue;
      const int place = inside ? static_cast<int>(halo_.box().offset(beside)) : -1;
      const bool shared = inside && solid[place] > 0.0;
      faces_.push_back({static_cast<int>(i), static_cast<int>(halo_.box().offset(element)), place, direction,
                        !shared || direction % 2 == 1});
    }
  }
}

template <int Dim>
std::vector<double> FilmFaces<Dim>::standing(std::span<const double> stage) const {
  return halo_.gather(part_.expand(stage, 0.0, 1.0));
}

template <int Dim>
double FilmFaces<Dim>::conductance(const Face& face, double coefficient) const {
  const Grid<Dim>& grid = part_.grid();
  const double area = grid.element_volume() / grid.spacing()[face.direction / 2];
  return coefficient * area / static_cast<double>(corners_[face.direction].size());
}

template <int Dim>
void FilmFaces<Dim>::add_film(std::span<const double> standing, double coefficient,
                              std::span<double> ghosted) const {
  for (const Face& face : faces_) {
    if (!face.counted) continue;
    const double jump = difference(face, standing);
    if (jump == 0.0) continue;
    for (const int corner : corners_[face.direction])
      ghosted[first_corners_[face.element] + corner] += conductance(face, coefficient) * jump * jump;
  }
}

template <int Dim>
void FilmFaces<Dim>::add_derivative(std::span<const double> standing, double coefficient,
                                    std::span<const double> d_film, int lanes,
                                    std::span<double> d_standing) const {
  for (const Face& face : faces_) {
    const double jump = difference(face, standing);
    if (jump == 0.0) continue;
    const double factor = 2.0 * jump * conductance(face, coefficient);
    for (const int corner : corners_[face.direction]) {
      const std::size_t node = static_cast<std::size_t>(first_corners_[face.element]) + corner;
      for (int lane = 0; lane < lanes; ++lane)
        d_standing[static_cast<std::size_t>(face.element) * lanes + lane] +=
            factor * d_film[node * lanes + lane];
    }
  }
}

FABSEQ_INSTANTIATE_CLASS(FilmFaces);

}  // namespace fabseq
