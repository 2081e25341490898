// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/element_halo.h"
#include "fabseq/part/part.h"

#include <span>
#include <vector>

namespace fabseq {

/// Fits a linear function to the times of the part elements around each one, which gives grad t where a
/// sequence has none (docs/developer/numerics.md 13.1). Elements count that are joined to it by faces within
/// `reach` elements along each axis, the near ones most. Construction is collective on the grid's
/// communicator. The part must outlive the object.
template <int Dim>
class TimeDifferences {
 public:
  /// \param time  a part field
  TimeDifferences(const Part<Dim>& part, std::span<const double> time, const Index<Dim>& reach);

  /// grad t, [part element][axis], 1/length; 0 where the times around an element have none. Local.
  std::vector<double> gradient() const;

 private:
  struct Sums;

  Sums sums_around(const Index<Dim>& element, std::vector<int>& visited,
                   std::vector<Index<Dim>>& front) const;

  const Part<Dim>& part_;
  Index<Dim> reach_;
  ElementHalo<Dim> halo_;
  std::vector<double> time_;  ///< on the halo's box, not a number outside the part
};

}  // namespace fabseq
