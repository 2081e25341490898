// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/element_halo.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/part/part.h"

#include <array>
#include <span>
#include <vector>

namespace fabseq {

/// The faces of part and substrate, through which heat leaves where material ends (docs/formulation.md 14.1):
///
///     H = sum over faces of h A (r_e - r_e')^2 / (nodes of the face) at its nodes,
///
/// with r the share of an element that stands, and 0 in the void and beyond the box. Faces of the box on the
/// plate's side have no film. Collective on the grid's communicator unless a call says otherwise.
template <int Dim>
class FilmFaces {
 public:
  /// `elements`: those of part and substrate, offsets in Grid::owned_elements(); `first_corners`: of each.
  /// The part must outlive the object.
  FilmFaces(const Part<Dim>& part, std::span<const int> elements, std::span<const int> first_corners);

  /// r of this rank's elements and of those beside them, from the part's stage densities.
  std::vector<double> standing(std::span<const double> stage) const;
  /// Adds H for h = `coefficient` to a field on the ghosted nodes. Local.
  void add_film(std::span<const double> standing, double coefficient, std::span<double> ghosted) const;
  /// Adds dJ/dr of the elements given, [element][lane], for dJ/dH = `d_film`, [ghosted node][lane]. Local.
  void add_derivative(std::span<const double> standing, double coefficient, std::span<const double> d_film,
                      int lanes, std::span<double> d_standing) const;

 private:
  struct Face {
    int element;      ///< among those given
    int own, beside;  ///< places in standing(); `beside` negative: beyond the box
    int direction;    ///< 2 * axis + side
    bool counted;     ///< for H: of two elements one has the face
  };
  double difference(const Face& face, std::span<const double> standing) const {
    return standing[face.own] - (face.beside < 0 ? 0.0 : standing[face.beside]);
  }
  /// h A / (nodes of the face).
  double conductance(const Face& face, double coefficient) const;

  const Part<Dim>& part_;
  ElementHalo<Dim> halo_;
  std::vector<int> first_corners_;
  std::array<std::array<int, corner_count<Dim> / 2>, 2 * Dim> corners_{};  ///< offsets of a face's nodes
  std::vector<Face> faces_;
};

}  // namespace fabseq
