// SPDX-License-Identifier: MIT
#include "responses/support_below.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Sharpness in depth and to the side, relative to that in time: a footing is half an element deep, so its
/// middle is never far from its ends.
constexpr double sharpness_of_footing = 0.25;
/// The lack of support where there is nothing at all around an element.
constexpr double largest_lack = 100.0;
/// Elements whose largest exponent is larger than another one's by more support by less than a rounding error
/// of what that one does; those with more than twice the lack of support, of that lack.
constexpr double negligible_support = 45.0;
/// Sub-parts that an element misses by more count it by less than any rounding error.
constexpr double negligible_count = 60.0;

/// ln(sum of e^x).
template <std::size_t Size>
double log_of_sum(const std::array<double, Size>& exponents) {
  const double largest = *std::max_element(exponents.begin(), exponents.end());
  double sum = 0.0;
  for (const double x : exponents) sum += std::exp(x - largest);
  return largest + std::log(sum);
}

}  // namespace

template <int Dim>
SupportBelow<Dim>::SupportBelow(const Part<Dim>& part, double bead_width, double sharpness)
    : part_(part),
      footing_(part.grid(), bead_width),
      steps_(footing_.steps()),
      halo_(part.grid(), reach_of<Dim>(steps_)),
      in_part_(halo_.gather(part.expand(std::vector<double>(part.elements().size(), 1.0), 0.0, 2.0))),
      edge_(*std::min_element(footing_.spacing.begin(), footing_.spacing.end())),
      sharpness_(sharpness),
      // Of each two opposite steps, one at most leads downwards.
      log_count_(std::log(0.5 * static_cast<double>(steps_.size()) + 1.0)) {
  for (const Index<Dim>& step : steps_) excesses_.emplace_back(footing_, step);
}

template <int Dim>
std::vector<double> SupportBelow<Dim>::gather(std::span<const double> time) const {
  return halo_.gather(part_.expand(time));
}

template <int Dim>
std::vector<double> SupportBelow<Dim>::scatter(std::span<const double> d_times) const {
  return part_.restrict_to_part(halo_.scatter_add(d_times));
}

/// The far side of the plate stands from the start.
template <int Dim>
typename SupportBelow<Dim>::Material SupportBelow<Dim>::material_at(const Index<Dim>& element) const {
  const auto [axis, upper] = part_.plate();
  if (upper ? element[axis] >= part_.grid().domain().elements[axis] : element[axis] < 0)
    return Material::standing;
  if (!halo_.box().contains(element)) return Material::none;
  const double mark = in_part_[halo_.box().offset(element)];
  return mark == 0.0 ? Material::none : mark == 1.0 ? Material::part : Material::standing;
}

/// Sets where the neighbour is and how late. Returns whether there is material.
template <int Dim>
bool SupportBelow<Dim>::find_material(const Index<Dim>& element, const BuildTime& when,
                                      std::span<const double> times, Neighbour& neighbour) const {
  const Material material = material_at(element);
  if (material == Material::none) return false;
  neighbour.exponent[Neighbour::late] = -BuildTime::infinite;
  if (material == Material::part) {
    neighbour.position = halo_.box().offset(element);
    const double latest = when.of_sub_part ? when.end : when.time;
    neighbour.exponent[Neighbour::late] = (times[neighbour.position] - latest) / (when.clock * sharpness_);
  }
  return true;
}

/// Most steps lead to elements that support by next to nothing beside the others.
template <int Dim>
std::vector<typename SupportBelow<Dim>::Neighbour> SupportBelow<Dim>::neighbours(
    std::size_t element, const BuildTime& when, const Point<Dim>& axis, std::span<const double> times) const {
  const Index<Dim> index = part_.grid().owned_elements().index(part_.elements()[element]);
  const auto extent = FootingExcess<Dim>::extent(footing_, axis);
  std::vector<Neighbour> result;
  result.reserve(steps_.size());
  double bound = 2.0 * largest_lack;
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    Neighbour neighbour{.step = s, .position = -1};
    const auto excess = excesses_[s].values(axis, extent);
    for (std::size_t k = 0; k < excess.size(); ++k)
      neighbour.exponent[k] = excess[k] / (sharpness_of_footing * sharpness_);
    neighbour.largest =
        *std::max_element(neighbour.exponent.begin(), neighbour.exponent.begin() + Neighbour::late);
    if (neighbour.largest > bound) continue;
    Index<Dim> other = index;
    for (int i = 0; i < Dim; ++i) other[i] += steps_[s][i];
    if (!find_material(other, when, times, neighbour)) continue;
    neighbour.largest = std::max(neighbour.largest, neighbour.exponent[Neighbour::late]);
    bound = std::min(bound, neighbour.largest + negligible_support);
    result.push_back(neighbour);
  }
  std::erase_if(result, [&](const Neighbour& neighbour) { return neighbour.largest > bound; });
  for (Neighbour& neighbour : result) neighbour.log_support = -log_of_sum(neighbour.exponent) - log_count_;
  return result;
}

template <int Dim>
std::array<double, 2> SupportBelow<Dim>::outside(const BuildTime& when) const {
  return {(when.begin - when.time) / (when.clock * sharpness_),
          (when.time - when.end) / (when.clock * sharpness_)};
}

template <int Dim>
bool SupportBelow<Dim>::may_belong(const BuildTime& when) const {
  const auto [before, after] = outside(when);
  return std::max(before, after) < negligible_count;
}

template <int Dim>
double SupportBelow<Dim>::log_support(const std::vector<Neighbour>& around, const BuildTime& when) const {
  const auto [before, after] = outside(when);
  std::array<double, 4> terms = {-largest_lack, before, after, -BuildTime::infinite};
  double largest = -largest_lack, sum = 0.0;
  for (const Neighbour& neighbour : around) largest = std::max(largest, neighbour.log_support);
  for (const Neighbour& neighbour : around) sum += std::exp(neighbour.log_support - largest);
  terms[3] = largest + std::log(sum);
  return log_of_sum(terms) - (when.of_sub_part ? std::log(3.0) : 0.0);
}

template <int Dim>
typename SupportBelow<Dim>::Support SupportBelow<Dim>::support(std::size_t element, const BuildTime& when,
                                                               const Point<Dim>& axis,
                                                               std::span<const double> times) const {
  Support result{.around = neighbours(element, when, axis, times)};
  result.lack = -log_support(result.around, when);
  return result;
}

/// Uses the bracket S: dX = sum_y (P_y / (n S)) sum_k (e^z_yk P_y) dz_yk + sum_u (e^-u / S) du.
template <int Dim>
LackDerivative<Dim> SupportBelow<Dim>::derivative(const Support& support, const BuildTime& when,
                                                  const Point<Dim>& axis, double weight,
                                                  std::span<double> d_times) const {
  const double log_bracket = -support.lack + (when.of_sub_part ? std::log(3.0) : 0.0);
  LackDerivative<Dim> result;
  for (const Neighbour& neighbour : support.around) {
    const double by_support = weight * std::exp(neighbour.log_support - log_bracket);
    std::array<double, Neighbour::late + 1> by;  // dX / dz_yk
    for (std::size_t k = 0; k < by.size(); ++k)
      by[k] = by_support * std::exp(neighbour.exponent[k] + neighbour.log_support + log_count_);
    std::array<double, FootingExcess<Dim>::count> by_excess;
    for (std::size_t k = 0; k < by_excess.size(); ++k)
      by_excess[k] = by[k] / (sharpness_of_footing * sharpness_);
    excesses_[neighbour.step].add_derivative(axis, by_excess, result.axis);
    if (by[Neighbour::late] == 0.0) continue;
    const double by_time = by[Neighbour::late] / (when.clock * sharpness_);
    d_times[neighbour.position] += by_time;
    if (!when.of_sub_part) result.time -= by_time;
    result.clock -= by[Neighbour::late] * neighbour.exponent[Neighbour::late] / when.clock;
  }
  const std::array<double, 2> beyond = outside(when);
  for (const int side : {0, 1}) {
    const double by = weight * std::exp(beyond[side] - log_bracket);  // dX / du
    if (by == 0.0) continue;
    result.time += (side == 0 ? by : -by) / (when.clock * sharpness_);
    result.clock += by * beyond[side] / when.clock;
  }
  return result;
}

FABSEQ_INSTANTIATE_CLASS(SupportBelow);

}  // namespace fabseq
