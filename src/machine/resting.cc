// SPDX-License-Identifier: MIT
#include "machine/resting.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace fabseq {

namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();
/// What a foot on plate, substrate or anything that these carry counts as: less than any place.
constexpr double ground = -1.0;

/// Spreads values from feet to what rests on them, the least value first.
template <int Dim>
class Spreading {
 public:
  Spreading(const Part<Dim>& part, const Feet<Dim>& feet, std::span<const double> layer_index)
      : part_(part), feet_(feet), values_(layer_index.size(), unknown) {
    for (std::size_t e = 0; e < values_.size(); ++e) order_.push_back(e);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return layer_index[a] < layer_index[b]; });
  }

  /// Gives a value to an element without feet, which keeps it. Local.
  void set(std::size_t e, double value) { values_[e] = value; }
  /// Spreads values until nothing changes on any rank. `value_of(value)`: what a foot with it counts as.
  /// Collective.
  template <class ValueOf>
  void spread(const ValueOf& value_of) {
    const MPI_Comm comm = part_.grid().comm();
    do around_ = feet_.halo().gather(part_.expand(values_, unknown));
    while (any(comm, spread_here(value_of)));
  }
  const std::vector<double>& values() const { return values_; }

 private:
  template <class ValueOf>
  bool spread_here(const ValueOf& value_of) {
    const IndexBox<Dim>& box = feet_.box();
    bool changed = false;
    for (bool again = true; again; changed |= again) {
      again = false;
      for (const std::size_t e : order_) {
        double least = values_[e];
        (void)feet_.any_of(e, [&](const Index<Dim>& foot, double layer) {
          least = std::min(least, value_of(layer == 0.0 ? ground : around_[box.offset(foot)]));
          return least == ground;
        });
        if (least == values_[e]) continue;
        values_[e] = around_[box.offset(part_.grid().owned_elements().index(part_.elements()[e]))] = least;
        again = true;
      }
      std::erase_if(order_, [&](std::size_t e) { return values_[e] == ground; });  // nothing is less
    }
    return changed;
  }

  const Part<Dim>& part_;
  const Feet<Dim>& feet_;
  std::vector<double> values_, around_;  ///< the second on the box of feet
  std::vector<std::size_t> order_;       ///< of elements whose value may change, by layer
};

}  // namespace

template <int Dim>
std::vector<int> places_that_carry(const Part<Dim>& part, const Feet<Dim>& feet,
                                   std::span<const double> layer_index, std::span<const int> places) {
  Spreading<Dim> spreading(part, feet, layer_index);
  // First what plate and substrate carry, then, of the rest, what places carry.
  spreading.spread([](double value) { return value == ground ? ground : unknown; });
  for (std::size_t e = 0; e < places.size(); ++e)
    if (places[e] >= 0) spreading.set(e, places[e]);
  spreading.spread([](double value) { return value == ground ? unknown : value; });
  std::vector<int> result;
  for (const double value : spreading.values())
    result.push_back(value == unknown ? -1 : static_cast<int>(value));
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(places_that_carry);

}  // namespace fabseq
