// SPDX-License-Identifier: MIT
/// \file
/// The responses by their formulas (docs/formulation.md 5 to 7), on fields of the whole grid.
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/responses/layer_statistics.h"
#include "support/pipeline_case.h"

#include <vector>

namespace fabseq::test {

/// Results of a pipeline on the whole grid, and the responses by formula.
template <int Dim>
struct Formulas {
  Formulas(const PipelineCase<Dim>& pipeline, const StageResults<Dim>& state)
      : grid(pipeline.setup.grid),
        corner(pipeline.setup.part.upper()),
        time_points(state.densities->time_points) {
    const Part<Dim>& part = pipeline.setup.part;
    const double length = 1.3;  // of the config
    const auto inside = whole_part_field(part, std::vector<double>(part.elements().size(), 1.0));
    density = whole_element_field<Dim>(grid, part.density());
    displacement = whole_node_field<Dim>(grid, state.process->displacement, Dim);
    for (std::size_t block = 0; block < state.process->increments.size(); ++block)
      for (int lane = 0; lane < state.process->increments[block].lanes; ++lane) {
        std::vector<double> counted(state.process->displacement.size());
        for (std::size_t i = 0; i < state.process->increments[block].unknowns(); ++i)
          counted[state.process->in_field(block, i, Dim)] = state.process->counted(block, i, lane);
        increments.push_back(whole_node_field<Dim>(grid, counted, Dim));
      }
    for (const auto& stage : state.densities->stage) stages.push_back(whole_part_field(part, stage));
    for (const auto& layer : state.densities->layer) {
      weights.push_back(whole_part_field(part, layer));
      for (std::size_t e = 0; e < inside.size(); ++e) weights.back()[e] += inside[e] * 1e-9;
    }
    std::vector<double> magnitude(part.elements().size());
    for (std::size_t e = 0; e < magnitude.size(); ++e) {
      double square = 1e-9 / (length * length);
      for (int a = 0; a < Dim; ++a) square += std::pow(state.time->gradient[e * Dim + a], 2);
      magnitude[e] = std::sqrt(square);
    }
    magnitudes = whole_part_field(part, magnitude);
    touched = whole_node_field<Dim>(
        grid, std::vector<double>(part.touched_nodes().begin(), part.touched_nodes().end()));
  }

  int layers() const { return static_cast<int>(weights.size()); }
  /// First unknowns of the part's nodes at the upper end of `axis`.
  std::vector<std::size_t> end_nodes(int axis) const {
    std::vector<std::size_t> result;
    grid.all_nodes().for_each([&](const Index<Dim>& node, std::int64_t n) {
      if (touched[n] != 0.0 && std::abs(grid.node_position(node)[axis] - corner[axis]) < 1e-9)
        result.push_back(n * Dim);
    });
    return result;
  }
  double tip_displacement(bool mean) const {
    const auto nodes = end_nodes(0);
    double total = 0.0;
    for (const std::size_t n : nodes)
      for (int a = 0; a < Dim; ++a) total += displacement[n + a] * displacement[n + a];
    return mean ? total / static_cast<double>(nodes.size()) : total;
  }
  double top_flatness() const {  // along x, as mean square minus squared mean
    double first = 0.0, second = 0.0;
    const auto nodes = end_nodes(Dim - 1);
    for (const std::size_t n : nodes) {
      first += displacement[n] / static_cast<double>(nodes.size());
      second += displacement[n] * displacement[n] / static_cast<double>(nodes.size());
    }
    return second - first * first;
  }
  double layerwise() const {
    double total = 0.0;
    for (const auto& increment : increments)
      for (const double u : increment) total += u * u;
    return total;
  }
  double weight(int j) const {
    double total = 0.0;
    for (const double w : weights[j]) total += w;
    return total;
  }
  double mean(int j) const { return moment(j, 1, 0.0) / weight(j); }
  double deviation(int j) const { return moment(j, 2, mean(j)); }
  /// sum of weight (M - about)^power.
  double moment(int j, int power, double about) const {
    double total = 0.0;
    for (std::size_t e = 0; e < magnitudes.size(); ++e)
      total += weights[j][e] * std::pow(magnitudes[e] - about, power);
    return total;
  }
  double part_volume() const {
    double total = 0.0;
    for (const double d : density) total += d * grid.element_volume();
    return total;
  }

  /// Returns the values in the order of the config.
  std::vector<std::vector<double>> values() const {
    double squares = 0.0, variance = 0.0;
    int filled = 0;
    std::vector<double> thickness, speed;
    for (int j = 0; j < layers(); ++j) {
      squares += deviation(j);
      thickness.push_back((time_points[j + 1] - time_points[j]) / mean(j) / 0.5);
      double built = 0.0;
      for (const double s : stages[j]) built += s * grid.element_volume();
      if (j + 1 < layers()) speed.push_back(built / part_volume() - time_points[j + 1]);
      if ((weight(j) - 1e-9 * static_cast<double>(magnitudes.size())) * grid.element_volume() <=
          1e-6 * part_volume() / layers())
        continue;
      variance += deviation(j) / (mean(j) * mean(j) * weight(j));
      ++filled;
    }
    return {{tip_displacement(false)},
            {tip_displacement(true)},
            {top_flatness()},
            {layerwise()},
            {squares},
            {variance / filled},
            thickness,
            speed};
  }

  const Grid<Dim>& grid;
  Point<Dim> corner;  ///< upper corner of the part
  std::vector<double> time_points, density, displacement, magnitudes, touched;
  std::vector<std::vector<double>> increments, stages, weights;
};

}  // namespace fabseq::test
