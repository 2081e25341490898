// SPDX-License-Identifier: MIT
#pragma once

#include "repair/cut_time.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace fabseq {

/// The smooth count of one of the machine's limits (docs/formulation.md 13.2), over the elements that fail
/// its exact check or have failed it. Calls are collective on the grid's communicator.
template <int Dim>
class PlaceLimit {
 public:
  /// The limit that a check is the exact one of; none if times cannot change what it says.
  static std::optional<PlaceLimit> of(const Model<Dim>& model, Fault fault);

  /// Counts no element any more.
  void forget();
  /// Counts the elements with a mark > 0 from now on, those that fail again by more each time.
  void count(std::span<const double> failing);
  /// The count, in units of elements at the limit.
  double value(const CutTime<Dim>& cut);
  /// Adds the derivatives with respect to times and gradients, after value().
  void add_derivatives(const CutTime<Dim>& cut, TimeDerivatives& derivatives) const;
  /// How much the elements count that fail.
  double failing() const { return failing_weight_; }

 private:
  PlaceLimit(const Model<Dim>& model, const ResponseType& type);

  MPI_Comm comm_;
  std::unique_ptr<std::vector<double>> weights_;  ///< the response refers to it
  std::unique_ptr<Response<Dim>> response_;
  std::size_t components_ = 0;
  double failing_weight_ = 0.0, scale_ = 0.0;
};

}  // namespace fabseq
