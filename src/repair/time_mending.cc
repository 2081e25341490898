// SPDX-License-Identifier: MIT
#include "repair/time_mending.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/components.h"
#include "fabseq/sequence/element_means.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace fabseq {

namespace {

constexpr int most_steps = 40, most_halved = 12;
constexpr std::size_t most_places = 12;
/// How often a change is smoothed: tried one after the other until a place is mended.
constexpr std::array smoothings = {1, 0, 2};
/// Share of the elements that fail by which a step is to lower the count, and of what its slope promises
/// that it has to.
constexpr double aim = 0.5, sufficient = 0.1;

/// Times of the owned nodes of which a pseudo-time is the mean; empty if they are not known.
template <int Dim>
std::vector<double> times_of_nodes(const Part<Dim>& part, const PseudoTime<Dim>& time) {
  constexpr double rounding = 1e-9;
  const MPI_Comm comm = part.grid().comm();
  std::vector<double> nodal = time.nodal;
  if (!any(comm, !nodal.empty())) {
    nodal = time.temperature;
    for (double& value : nodal) value = 1.0 - value;
  }
  if (!any(comm, !nodal.empty())) return {};
  const ElementMatrices<Dim> element(part.grid().spacing(), 1.0, 0.0);
  const ElementMeans means = element_means(part, element, part.grid().exchange(1).ghosted(nodal));
  bool same = true;
  for (std::size_t e = 0; e < time.time.size(); ++e)
    same = same && std::abs(means.mean[e] - time.time[e]) < rounding;
  return any(comm, !same) ? std::vector<double>() : nodal;
}

}  // namespace

template <int Dim>
TimeMending<Dim>::TimeMending(const Model<Dim>& model, const Layers& layers)
    : model_(model), layers_(layers), element_(model.grid.spacing(), 1.0, 0.0) {
  for (std::size_t i = 0; i < all_faults.size(); ++i)
    if (auto limit = PlaceLimit<Dim>::of(model, all_faults[i])) {
      limits_.push_back(*std::move(limit));
      checks_.push_back(i);
    }
}

template <int Dim>
CutTime<Dim> TimeMending<Dim>::mend(const CutTime<Dim>& start, double most_elements) {
  const MPI_Comm comm = model_.grid.comm();
  if (!any(comm, !start.time.gradient.empty()) ||
      !any(comm, !times_of_nodes(model_.part, start.time).empty()))
    return start;
  CutTime<Dim> best = start;
  for (const std::vector<double>& place : places_of(start)) {
    const CutTime<Dim> before = best;
    for (const int smoothing : smoothings) {
      CutTime<Dim> mended = mend_place(before, place, smoothing);
      if (mended.is_better_than(best) &&
          static_cast<double>(count_moved(model_.part, start, mended)) <= most_elements)
        best = std::move(mended);
      if (!still_fails(best, place)) break;
    }
  }
  return best;
}

/// The elements of each place, those with the fewest first.
template <int Dim>
std::vector<std::vector<double>> TimeMending<Dim>::places_of(const CutTime<Dim>& cut) const {
  std::vector<double> fails;
  for (std::size_t e = 0; e < cut.layer.size(); ++e) fails.push_back(cut.fails(e) ? 1.0 : 0.0);
  const Components found = find_components<Dim>(model_.grid, model_.part.expand(fails), Contact::corner);
  std::vector<std::vector<double>> places(static_cast<std::size_t>(found.count),
                                          std::vector<double>(fails.size(), 0.0));
  std::vector<std::int64_t> sizes(places.size(), 0);
  for (std::size_t e = 0; e < fails.size(); ++e)
    if (const int place = found.of_element[model_.part.elements()[e]]; place >= 0) {
      places[place][e] = 1.0;
      ++sizes[place];
    }
  sum_in_place(model_.grid.comm(), std::span<std::int64_t>(sizes));
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sizes[a] < sizes[b]; });
  order.resize(std::min(order.size(), most_places));
  std::vector<std::vector<double>> result;
  for (const std::size_t place : order) result.push_back(std::move(places[place]));
  return result;
}

/// Goes on until the place fails no check, for at most so many steps; what fails elsewhere does not count.
template <int Dim>
CutTime<Dim> TimeMending<Dim>::mend_place(const CutTime<Dim>& start, const std::vector<double>& place,
                                          int smoothing) {
  std::vector<double> nodal = times_of_nodes(model_.part, start.time), elsewhere(place.size());
  for (std::size_t e = 0; e < place.size(); ++e) elsewhere[e] = start.fails(e) && place[e] == 0.0 ? 1.0 : 0.0;
  for (PlaceLimit<Dim>& limit : limits_) limit.forget();
  CutTime<Dim> best = start, now = start;
  for (int k = 0; k < most_steps; ++k) {
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      std::vector<double> marks = now.marks[checks_[i]];
      for (std::size_t e = 0; e < marks.size(); ++e) marks[e] *= 1.0 - elsewhere[e];
      limits_[i].count(marks);
    }
    if (!step(start.time, now, nodal, smoothing)) break;
    if (!now.is_better_than(best)) continue;
    best = now;
    if (!still_fails(best, place)) break;
  }
  return best;
}

/// Whether an element of a place fails any check.
template <int Dim>
bool TimeMending<Dim>::still_fails(const CutTime<Dim>& cut, const std::vector<double>& place) const {
  bool fails = false;
  for (std::size_t e = 0; e < place.size(); ++e) fails = fails || (place[e] > 0.0 && cut.fails(e));
  return any(model_.grid.comm(), fails);
}

/// The sum of the counts.
template <int Dim>
double TimeMending<Dim>::count_of(const CutTime<Dim>& cut) {
  double total = 0.0;
  for (PlaceLimit<Dim>& limit : limits_) total += limit.value(cut);
  return total;
}

/// Takes a step down the smoothed gradient of the counts with respect to the times of the nodes. The first
/// step that is tried aims at a fall by half the weight of the failing elements. Returns false if no step
/// lowers the sum of the counts.
template <int Dim>
bool TimeMending<Dim>::step(const PseudoTime<Dim>& from, CutTime<Dim>& now, std::vector<double>& nodal,
                            int smoothing) {
  const double count = count_of(now);
  double failing = 0.0;
  TimeDerivatives derivatives;
  derivatives.time.assign(now.time.time.size(), 0.0);
  derivatives.gradient.assign(now.time.time.size() * Dim, 0.0);
  for (const PlaceLimit<Dim>& limit : limits_) {
    failing += limit.failing();
    limit.add_derivatives(now, derivatives);
  }
  const std::vector<double> gradient = pull_back_means<Dim>(model_.part, element_, {&derivatives, 1}).lane(0);
  const std::vector<double> direction = smoothed(gradient, smoothing);
  const double slope =
      sum(model_.grid.comm(), std::inner_product(gradient.begin(), gradient.end(), direction.begin(), 0.0));
  if (!(slope > 0.0)) return false;
  double length = aim * failing / slope;
  for (int halved = 0; halved < most_halved; ++halved, length *= 0.5) {
    std::vector<double> tried = nodal;
    for (std::size_t n = 0; n < tried.size(); ++n) tried[n] -= length * direction[n];
    CutTime<Dim> there = cut(model_, layers_, time_of(from, tried));
    if (count_of(there) > count - sufficient * length * slope) continue;
    now = std::move(there);
    nodal = std::move(tried);
    return true;
  }
  return false;
}

/// Means over the elements around each node, of means over their nodes: symmetric and not negative.
template <int Dim>
std::vector<double> TimeMending<Dim>::smoothed(std::vector<double> nodal, int times) const {
  for (int k = 0; k < times; ++k) {
    TimeDerivatives means;
    means.time = element_means(model_.part, element_, model_.grid.exchange(1).ghosted(nodal)).mean;
    nodal = pull_back_means<Dim>(model_.part, element_, {&means, 1}).lane(0);
  }
  return nodal;
}

/// The pseudo-time of which these are the times of the nodes.
template <int Dim>
PseudoTime<Dim> TimeMending<Dim>::time_of(const PseudoTime<Dim>& from,
                                          const std::vector<double>& nodal) const {
  PseudoTime<Dim> result = from;
  ElementMeans means = element_means(model_.part, element_, model_.grid.exchange(1).ghosted(nodal));
  result.time = std::move(means.mean);
  result.gradient = std::move(means.gradient);
  if (!from.temperature.empty())
    for (std::size_t n = 0; n < nodal.size(); ++n) result.temperature[n] = 1.0 - nodal[n];
  if (!from.nodal.empty()) result.nodal = nodal;
  return result;
}

FABSEQ_INSTANTIATE_CLASS(TimeMending);

}  // namespace fabseq
