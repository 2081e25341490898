// SPDX-License-Identifier: MIT
#include "lane_case.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>

namespace benchmarks {

using fabseq::Index;
using fabseq::LaneArray;
using fabseq::Point;

constexpr double min_stiffness = 1e-9, penalty = 3.0;

DrawnPart drawn_v_shape(int elements, double sharpness) {
  return {.elements = {elements, elements / 2, elements}, .sharpness = sharpness};
}

DrawnPart drawn_box(int elements) {
  return {.elements = {elements, elements / 2, elements},
          .contains = [](const auto&, auto&) { return true; }};
}

LaneCase::LaneCase(MPI_Comm comm, const DrawnPart& part)
    : part_(part), grid_(comm, {part.size, part.elements}, {}), problem_(1.0, part.poisson) {
  // The shares of 25 layers that the prototype of the engine was measured with.
  constexpr std::array<double, lanes> shares{0.08, 0.2, 0.36, 0.52, 0.6, 0.68, 0.84, 1.0};
  for (int lane = 0; lane < lanes; ++lane)
    layers_[lane] = std::max(1, static_cast<int>(std::lround(shares[lane] * part.layer_count)));
  fabseq::SystemDomain domain;
  domain.components = 3;
  grid_.owned_elements().for_each([&](const Index<3>& element, std::int64_t) {
    const Point<3> center = grid_.element_center(element);
    const bool in_part = part.contains(center, element);
    if (!in_part && !part.quiet_void) return;
    domain.first_corners.push_back(grid_.first_corner(element));
    elements_.push_back({element, in_part ? part.time(center, element) : 0.0, in_part});
  });
  domain.fixed.assign(static_cast<std::size_t>(grid_.owned_nodes().count()) * 3, 0);
  grid_.owned_nodes().for_each([&](const Index<3>& node, std::int64_t offset) {
    if (node[2] == 0) std::fill_n(domain.fixed.begin() + offset * 3, 3, 1);
  });
  hierarchy_ = std::make_unique<fabseq::LaneHierarchy<3>>(grid_, domain);
}

double LaneCase::stage_density(const Element& element, int layer) const {
  if (layer == 0 || !element.in_part) return 0.0;
  if (layer == part_.layer_count) return 1.0;
  const double threshold = static_cast<double>(layer) / part_.layer_count;
  const double below = std::tanh(part_.sharpness * threshold);
  return std::max(0.0, 1.0 - (below + std::tanh(part_.sharpness * (element.time - threshold))) /
                                 (below + std::tanh(part_.sharpness * (1.0 - threshold))));
}

void LaneCase::fill(LaneArray& coefficients) const {
  const auto& mesh = hierarchy_->level(0).mesh;
  for (const Element& element : elements_)
    for (int lane = 0; lane < lanes; ++lane)
      coefficients[static_cast<std::size_t>(mesh.element_number(element.index)) * lanes + lane] =
          min_stiffness + (1.0 - min_stiffness) * std::pow(stage_density(element, layers_[lane]), penalty);
}

LaneArray LaneCase::load() {
  const auto& mesh = hierarchy_->level(0).mesh;
  const std::vector<double> strain{-0.01, -0.01, -0.01, 0.0, 0.0, 0.0};
  const auto forces = fabseq::ElementMatrices<3>(grid_.spacing(), 1.0, part_.poisson).strain_load(strain);
  LaneArray load(static_cast<std::size_t>(mesh.nodes()) * 3 * lanes, 0.0);
  for (const Element& element : elements_)
    for (int lane = 0; lane < lanes; ++lane) {
      const double grown = stage_density(element, layers_[lane]) - stage_density(element, layers_[lane] - 1);
      const double share = std::pow(std::max(0.0, grown), penalty);
      for (int corner = 0; corner < 8; ++corner) {
        Index<3> node = element.index;
        for (int axis = 0; axis < 3; ++axis) node[axis] += (corner >> axis) & 1;
        for (int a = 0; a < 3; ++a)
          load[(static_cast<std::size_t>(mesh.node_number(node)) * 3 + a) * lanes + lane] +=
              share * forces[corner * 3 + a];
      }
    }
  fabseq::sum_over_holders(hierarchy_->level(0), load.data(), 3 * lanes);
  return load;
}

double LaneCase::filled() const {
  const std::int64_t in_part = std::ranges::count(elements_, true, &Element::in_part);
  return static_cast<double>(fabseq::sum(grid_.comm(), in_part)) /
         static_cast<double>(grid_.all_elements().count());
}

}  // namespace benchmarks
