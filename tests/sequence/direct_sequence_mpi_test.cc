// SPDX-License-Identifier: MIT
/// Direct sequences: values, and derivatives against differences (formulation 2.3).
#include "sequence/direct_sequence.h"
#include "support/heat_case.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <int Dim>
struct DirectCase {
  explicit DirectCase(DesignLocation location, double filter_radius = 0.0)
      : region(make_start_region(on_grid.part, location, std::nullopt)),
        support(on_grid.grid, location == DesignLocation::nodes, region.free),
        sequence(make_direct_sequence(on_grid.part, support, region, filter_radius)) {}

  std::vector<double> noise(double low, double high, int salt) const {
    std::vector<double> result;
    for (std::size_t i = 0; i < support.size(); ++i)
      result.push_back(low + (high - low) * test::noise(support.number(i), salt));
    return result;
  }

  test::PartOnGrid<Dim> on_grid{test::odd_domain<Dim>(), test::gallows<Dim>()};
  StartRegion region;
  DesignSupport<Dim> support;
  std::unique_ptr<Sequence<Dim>> sequence;
};

template <class T>
class DirectSequenceTest : public testing::Test {};
TYPED_TEST_SUITE(DirectSequenceTest, test::Dimensions);

TYPED_TEST(DirectSequenceTest, TimeOfElementsIsTheDesign) {
  constexpr int Dim = TypeParam::value;
  const DirectCase<Dim> direct(DesignLocation::elements);
  EXPECT_TRUE(direct.sequence->has_design());
  EXPECT_EQ(direct.sequence->variables(), direct.region.free.size());
  EXPECT_EQ(direct.sequence->initial_design(), direct.region.initial_time);
  const std::vector<double> design = direct.noise(0.1, 1.0, 2);
  const PseudoTime<Dim>& time = direct.sequence->update(design);
  EXPECT_TRUE(time.gradient.empty());
  std::size_t next = 0;
  for (std::size_t e = 0; e < time.time.size(); ++e)
    EXPECT_EQ(time.time[e], direct.region.elements[e] != 0 ? 0.0 : design[next++]);
}

/// A linear field is what it is at the centres, and its gradient everywhere the same.
TYPED_TEST(DirectSequenceTest, TimeOfNodesIsTheirMean) {
  constexpr int Dim = TypeParam::value;
  const DirectCase<Dim> direct(DesignLocation::nodes);
  const Grid<Dim>& grid = direct.on_grid.grid;
  const auto linear = [](const Point<Dim>& x) {  // 0 on the plate
    return 0.37 * x[Dim - 1];
  };
  std::vector<double> design;
  for (const int node : direct.support.places())
    design.push_back(linear(grid.node_position(grid.owned_nodes().index(node))));
  const PseudoTime<Dim>& time = direct.sequence->update(design);
  ASSERT_EQ(time.time.size(), direct.on_grid.part.elements().size());
  for (std::size_t e = 0; e < time.time.size(); ++e) {
    const auto center = grid.element_center(grid.owned_elements().index(direct.on_grid.part.elements()[e]));
    EXPECT_NEAR(time.time[e], linear(center), 1e-14);
    for (int axis = 0; axis < Dim; ++axis)
      EXPECT_NEAR(time.gradient[e * Dim + axis], axis == Dim - 1 ? 0.37 : 0.0, 1e-13);
  }
  EXPECT_TRUE(time.temperature.empty());
}

TYPED_TEST(DirectSequenceTest, DerivativesAgreeWithDifferences) {
  constexpr int Dim = TypeParam::value;
  for (const auto& [location, radius] :
       {std::pair(DesignLocation::elements, 0.0), std::pair(DesignLocation::nodes, 0.0),
        std::pair(DesignLocation::elements, 1.1), std::pair(DesignLocation::nodes, 1.1)}) {
    const DirectCase<Dim> direct(location, radius);
    std::vector<TimeDerivatives> rows = test::time_functionals(direct.on_grid.part, 11);
    if (location == DesignLocation::elements)
      for (TimeDerivatives& row : rows) row.gradient.clear();
    const auto design = direct.noise(0.1, 0.9, 0), direction = direct.noise(-1.0, 1.0, 5);
    const auto gradients = direct.sequence->pull_back(rows);
    ASSERT_EQ(gradients.size(), rows.size());
    for (std::size_t row = 0; row < rows.size(); ++row) {
      ASSERT_EQ(gradients[row].size(), direct.support.size());
      const double expected = test::central_difference(
          [&](double step) {
            const PseudoTime<Dim>& time = direct.sequence->update(test::moved(design, step, direction));
            const double of_time = test::dot(rows[row].time, time.time);
            return rows[row].gradient.empty() ? of_time
                                              : of_time + test::dot(rows[row].gradient, time.gradient);
          },
          1e-2);
      EXPECT_NEAR(test::dot(gradients[row], direction), expected, 1e-10 * std::max(1.0, std::abs(expected)));
    }
  }
}

}  // namespace
}  // namespace fabseq
