#include "kernels/graded_part.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace benchmarks {

using fabseq::Index;
using fabseq::LaneArray;
using fabseq::Point;

namespace {

constexpr double poisson = 0.3;
constexpr double min_stiffness = 1e-9;
constexpr int layer_count = 25;
constexpr std::array<int, GradedPart::lanes> layers{2, 5, 9, 13, 15, 17, 21, 25};

/// part of configs/v_shape.json.
bool inside_v(const Point<3>& at) { return (at[2] < 0.6 || at[0] > 1.2) && at[2] > at[0] - 1.0; }

}  // namespace

GradedPart::GradedPart(Shape shape, const Index<3>& elements, double sharpness)
    : grid_(MPI_COMM_SELF, {{2.0, 1.0, 2.0}, elements}, {}), sharpness_(sharpness), problem_(1.0, poisson) {
  fabseq::SystemDomain domain;
  domain.components = 3;
  grid_.owned_elements().for_each([&](const Index<3>& element, std::int64_t) {
    const Point<3> center = fabseq::element_center<3>(grid_.domain(), element);
    if (shape == Shape::v && !inside_v(center)) return;
    domain.first_corners.push_back(grid_.first_corner(element));
    elements_.push_back({element, 0.35 * center[2] + 0.15 * center[0]});
  });
  domain.fixed.assign(static_cast<std::size_t>(grid_.owned_nodes().count()) * 3, 0);
  grid_.owned_nodes().for_each([&](const Index<3>& node, std::int64_t offset) {
    if (node[2] == 0) std::fill_n(domain.fixed.begin() + offset * 3, 3, 1);
  });
  hierarchy_ = std::make_unique<fabseq::LaneHierarchy<3>>(grid_, domain);
}

double GradedPart::stage_density(const Element& element, int layer) const {
  if (layer == 0) return 0.0;
  if (layer == layer_count) return 1.0;
  const double threshold = static_cast<double>(layer) / layer_count;
  const double below = std::tanh(sharpness_ * threshold);
  return 1.0 - (below + std::tanh(sharpness_ * (element.time - threshold))) /
                   (below + std::tanh(sharpness_ * (1.0 - threshold)));
}

void GradedPart::fill(LaneArray& coefficients) const {
  const auto& mesh = hierarchy_->level(0).mesh;
  for (const Element& element : elements_)
    for (int lane = 0; lane < lanes; ++lane)
      coefficients[static_cast<std::size_t>(mesh.element_number(element.index)) * lanes + lane] =
          min_stiffness +
          (1.0 - min_stiffness) * std::pow(std::max(0.0, stage_density(element, layers[lane])), 3);
}

LaneArray GradedPart::load() const {
  const auto& mesh = hierarchy_->level(0).mesh;
  const std::vector<double> strain{-0.01, -0.01, -0.01, 0.0, 0.0, 0.0};
  const auto forces = fabseq::ElementMatrices<3>(grid_.spacing(), 1.0, poisson).strain_load(strain);
  LaneArray load(static_cast<std::size_t>(mesh.nodes()) * 3 * lanes, 0.0);
  for (const Element& element : elements_)
    for (int lane = 0; lane < lanes; ++lane) {
      const double share = std::pow(
          std::max(0.0, stage_density(element, layers[lane]) - stage_density(element, layers[lane] - 1)), 3);
      for (int corner = 0; corner < 8; ++corner) {
        Index<3> node = element.index;
        for (int axis = 0; axis < 3; ++axis) node[axis] += (corner >> axis) & 1;
        for (int a = 0; a < 3; ++a)
          load[(static_cast<std::size_t>(mesh.node_number(node)) * 3 + a) * lanes + lane] +=
              share * forces[corner * 3 + a];
      }
    }
  return load;
}

}  // namespace benchmarks
