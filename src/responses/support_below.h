// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/element_halo.h"
#include "fabseq/part/part.h"
#include "responses/footing_excess.h"

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace fabseq {

/// Times at which a part element is built, all in pseudo-time.
struct BuildTime {
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  double time;   ///< t of the element
  double clock;  ///< how long the shortest edge of an element takes there
  bool of_sub_part = false;
  double begin = -infinite, end = infinite;  ///< of the sub-part, if there are any
};

/// Derivatives of a lack of support with respect to BuildTime::time and clock and to the build direction.
template <int Dim>
struct LackDerivative {
  double time = 0.0, clock = 0.0;
  Point<Dim> axis{};
};

/// What each part element lacks of support from below, as a smooth logarithm X (docs/formulation.md 13.2),
///
///     e^-X = (1/c) [ (1/n) sum_y P_y + e^-u_begin + e^-u_end ],  P_y = 1 / sum_k e^z_yk,
///
/// with the sum over the elements y of part, substrate and plate around it, z_yk by how much y is too high,
/// too low, too far to the side and too late, and u how far the element is within the time of its sub-part
/// (multi-planar layers only, c = 3; else c = 1). X >= 0 where the exact check finds that the element hangs.
/// Construction, gather() and scatter() are collective on the grid's communicator, nothing else is.
template <int Dim>
class SupportBelow {
 public:
  /// The part must outlive the object. \param bead_width  length unit; 0: two elements' longest edges
  /// \param sharpness  in elements
  SupportBelow(const Part<Dim>& part, double bead_width, double sharpness);
  SupportBelow(SupportBelow&&) = delete;

  /// Shortest edge of an element, length unit.
  double edge() const { return edge_; }
  /// Pseudo-times (a part field) on the elements around those of this rank.
  std::vector<double> gather(std::span<const double> time) const;
  /// Applies the transpose of gather().
  std::vector<double> scatter(std::span<const double> d_times) const;

  /// Whether the element counts in its sub-part by more than a trace.
  bool may_belong(const BuildTime& when) const;
  /// An element around another one that may support it.
  struct Neighbour {
    static constexpr std::size_t late = FootingExcess<Dim>::count;
    std::size_t step;                         ///< number of the step to it
    std::ptrdiff_t position;                  ///< in the halo's box; -1: it stands from the start
    std::array<double, late + 1> exponent{};  ///< z_yk
    double largest = 0.0;                     ///< of these
    double log_support = 0.0;                 ///< ln(P_y / n)
  };
  /// What supports a part element, and what it lacks.
  struct Support {
    std::vector<Neighbour> around;
    double lack = 0.0;  ///< X
  };

  /// Support of a part element. \param axis  its build direction \param times  gather()
  Support support(std::size_t element, const BuildTime& when, const Point<Dim>& axis,
                  std::span<const double> times) const;
  /// Derivatives of `weight` X. Adds those with respect to the times of other elements to `d_times`, shaped
  /// as the times.
  LackDerivative<Dim> derivative(const Support& support, const BuildTime& when, const Point<Dim>& axis,
                                 double weight, std::span<double> d_times) const;

 private:
  enum class Material : char { none, part, standing };

  Material material_at(const Index<Dim>& element) const;
  std::vector<Neighbour> neighbours(std::size_t element, const BuildTime& when, const Point<Dim>& axis,
                                    std::span<const double> times) const;
  bool find_material(const Index<Dim>& element, const BuildTime& when, std::span<const double> times,
                     Neighbour& neighbour) const;
  /// -u_begin and -u_end.
  std::array<double, 2> outside(const BuildTime& when) const;
  /// -X of a bracket that holds these terms.
  double log_support(const std::vector<Neighbour>& around, const BuildTime& when) const;

  const Part<Dim>& part_;
  Footing<Dim> footing_;
  std::vector<Index<Dim>> steps_;
  std::vector<FootingExcess<Dim>> excesses_;  ///< of the steps
  ElementHalo<Dim> halo_;
  std::vector<double> in_part_;  ///< on the halo's box: 1 in the part, 2 in the substrate
  double edge_, sharpness_, log_count_;
};

}  // namespace fabseq
