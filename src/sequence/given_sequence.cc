// SPDX-License-Identifier: MIT
#include "fabseq/sequence/given_sequence.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/hdf5.h"
#include "fabseq/base/mpi.h"
#include "fabseq/files/hdf5_writer.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace fabseq {

namespace {

template <int Dim>
Point<Dim> unit_direction(const Part<Dim>& part, const std::vector<double>& direction) {
  if (direction.empty()) return part.plate().template normal<Dim>();
  Point<Dim> result{};
  double square = 0.0;
  for (const double d : direction) square += d * d;
  for (int axis = 0; axis < Dim; ++axis) result[axis] = direction[axis] / std::sqrt(square);
  return result;
}

/// Heights of the centres of this rank's part elements, and of the lowest and highest corner of all part
/// elements. Construction is collective.
template <int Dim>
struct Heights {
  std::vector<double> centers;
  double lowest = std::numeric_limits<double>::max(), highest = std::numeric_limits<double>::lowest();

  Heights(const Part<Dim>& part, const Point<Dim>& direction) {
    const Grid<Dim>& grid = part.grid();
    double half = 0.0;
    for (int axis = 0; axis < Dim; ++axis) half += 0.5 * grid.spacing()[axis] * std::abs(direction[axis]);
    for (const int element : part.elements()) {
      const Point<Dim> center = grid.element_center(grid.owned_elements().index(element));
      double height = 0.0;
      for (int axis = 0; axis < Dim; ++axis) height += center[axis] * direction[axis];
      centers.push_back(height);
      lowest = std::min(lowest, height - half);
      highest = std::max(highest, height + half);
    }
    lowest = min(grid.comm(), lowest);
    highest = max(grid.comm(), highest);
  }
};

}  // namespace

template <int Dim>
PseudoTime<Dim> planar_time(const Part<Dim>& part, std::vector<double> direction) {
  const Point<Dim> normal = unit_direction(part, direction);
  const Heights<Dim> heights(part, normal);
  const double height = heights.highest - heights.lowest;
  PseudoTime<Dim> result;
  for (const double center : heights.centers) {
    result.time.push_back((center - heights.lowest) / height);
    for (const double component : normal) result.gradient.push_back(component / height);
  }
  return result;
}

template <int Dim>
double planar_height(const Part<Dim>& part, std::vector<double> direction) {
  const Heights<Dim> heights(part, unit_direction(part, direction));
  return heights.highest - heights.lowest;
}

namespace {

/// What is recorded beside a time; empty if there is none.
template <int Dim>
std::vector<double> recorded_gradient(const Part<Dim>& part, const std::string& file,
                                      const std::string& dataset) {
  const std::string name = dataset + "_gradient";
  if (!hdf5_file_has(part.grid().comm(), file, name, "/sequence/file")) return {};
  const std::vector<double> field =
      read_field(part.grid(), false, file, name, "/sequence/file", "/sequence/file", Dim);
  std::vector<double> result;
  for (const int element : part.elements()) {
    const auto first = field.begin() + static_cast<std::ptrdiff_t>(element) * Dim;
    result.insert(result.end(), first, first + Dim);
  }
  const auto is_finite = [](double component) { return std::isfinite(component); };
  if (any(part.grid().comm(), !std::all_of(result.begin(), result.end(), is_finite)))
    throw InputError("/sequence/file: dataset \"" + name + "\" of " + file +
                     " holds values that are no numbers; allowed: the gradient of \"" + dataset +
                     "\" on all part elements");
  return result;
}

/// Times of the nodes that a result has beside the times of its elements, or that its temperatures are; empty
/// if there are none.
template <int Dim>
std::vector<double> recorded_nodal_time(const Part<Dim>& part, const std::string& file,
                                        const std::string& dataset) {
  constexpr std::string_view own = "time";
  if (!dataset.ends_with(own)) return {};
  const MPI_Comm comm = part.grid().comm();
  const std::string prefix = dataset.substr(0, dataset.size() - own.size());
  const auto read = [&](const char* name) {
    if (!hdf5_file_has(comm, file, prefix + name, "/sequence/file")) return std::vector<double>();
    return read_field(part.grid(), true, file, prefix + name, "/sequence/file", "/sequence/file");
  };
  std::vector<double> times = read("nodal_time");
  if (!any(comm, !times.empty())) {
    times = read("temperature");
    for (double& value : times) value = 1.0 - value;
  }
  const auto is_finite = [](double time) { return std::isfinite(time); };
  if (any(comm, !std::all_of(times.begin(), times.end(), is_finite))) times.clear();
  return times;
}

/// Throws InputError on all ranks for values that are no pseudo-times, and brings those there that leave
/// [0, 1] by rounding. Guided times go a little beyond 1 where the part does not end with its last layer.
/// Most of seconds, or of numbers of layers, are beyond it; whoever writes a gradient beside them means
/// times.
template <int Dim>
void require_times(const Part<Dim>& part, PseudoTime<Dim>& time, const std::string& file,
                   const std::string& dataset) {
  constexpr double rounding = 1e-6, most_beyond = 0.5, least_share_inside = 0.5;
  const MPI_Comm comm = part.grid().comm();
  const bool has_gradient = any(comm, !time.recorded_gradient.empty());
  double lowest = 0.0, highest = 1.0, inside = 0.0;
  bool finite = true;
  for (double& t : time.time) {
    if (!has_gradient && t > -rounding && t < 1.0 + rounding) t = std::clamp(t, 0.0, 1.0);
    finite = finite && std::isfinite(t);
    lowest = std::min(lowest, t);
    highest = std::max(highest, t);
    inside += t >= 0.0 && t <= 1.0 ? 1.0 : 0.0;
  }
  lowest = min(comm, lowest);
  highest = max(comm, highest);
  const bool usual = sum(comm, inside) >= least_share_inside * static_cast<double>(part.count()) &&
                     lowest >= -most_beyond && highest <= 1.0 + most_beyond;
  const std::string name = "/sequence/file: dataset \"" + dataset + "\" of " + file + " holds ";
  if (any(comm, !finite))
    throw InputError(name + "values that are no numbers; allowed: times on all part elements");
  if (!usual && !has_gradient)
    throw InputError(name + "values outside the part's time range, " +
                     formatted("from %.6g to %.6g", lowest, highest) +
                     "; allowed: 0 to 1 on all part elements");
}

}  // namespace

template <int Dim>
PseudoTime<Dim> time_from_file(const Part<Dim>& part, const std::string& file, const std::string& dataset) {
  PseudoTime<Dim> result;
  result.time = part.restrict_to_part(read_field(part.grid(), false, file, dataset));
  result.recorded_gradient = recorded_gradient(part, file, dataset);
  result.nodal = recorded_nodal_time(part, file, dataset);
  require_times(part, result, file, dataset);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(planar_time);
FABSEQ_INSTANTIATE_FUNCTION(planar_height);
FABSEQ_INSTANTIATE_FUNCTION(time_from_file);

}  // namespace fabseq
