// SPDX-License-Identifier: MIT
/// Repair of binary layers (docs/developer/repair.md 13.5) on a block in planar layers that are disturbed at
/// one place, judged by the definitions of the checks.
#include "fabseq/config/setup.h"
#include "fabseq/repair/layer_repair.h"
#include "fabseq/sequence/element_means.h"
#include "fabseq/sequence/given_sequence.h"
#include "repair/place_limit.h"
#include "support/small_configs.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace fabseq {
namespace {

constexpr int width = 9, height = 10;
/// Unit cubes, one layer each.
constexpr const char* block = R"({
  "domain": {"size": [9, 9, 10], "elements": [9, 9, 10]},
  "part": {"box": {"min": [0, 0, 0], "max": [9, 9, 10]}},
  "node_sets": {"top": {"box": {"min": [0, 0, 10], "max": [9, 9, 10]}}},
  "sequence": {"type": "planar"},
  "layers": {"count": 10},
  "objective": [{"type": "distortion", "nodes": "top"}],
  "constraints": [{"type": "layer_thickness", "target": 1}],
  "tool": {"thickness": [0.8, 1.15], "max_tilt": 45, "bead_width": 2}
})";

class LayerRepairTest : public testing::Test {
 protected:
  explicit LayerRepairTest(const Settings& settings = {}) : config_(configure(block, settings)) {}

  std::vector<double> planar_nodes() const {
    std::vector<double> times;
    setup_.grid.owned_nodes().for_each(
        [&](const Index<3>& node, std::int64_t) { times.push_back(static_cast<double>(node[2]) / height); });
    return times;
  }
  /// The pseudo-time whose nodes have these times.
  PseudoTime<3> time_of(const std::vector<double>& nodal) const {
    const ElementMatrices<3> element(setup_.grid.spacing(), 1.0, 0.0);
    ElementMeans means = element_means<3>(setup_.part, element, setup_.grid.exchange(1).ghosted(nodal));
    PseudoTime<3> result;
    result.time = std::move(means.mean);
    result.gradient = std::move(means.gradient);
    result.nodal = nodal;
    return result;
  }
  /// Adds to the time of a node.
  void disturb(std::vector<double>& nodal, const Index<3>& which, double by) const {
    if (setup_.grid.owned_nodes().contains(which)) nodal[setup_.grid.owned_nodes().offset(which)] += by;
  }
  std::optional<RepairedTime<3>> repaired(const PseudoTime<3>& time) const {
    return repair_layers<3>(setup_, time, {}, 0.005);
  }
  /// Of the whole block, by element.
  std::map<Index<3>, int> layers_of(const PseudoTime<3>& time) const {
    const std::vector<double> whole =
        test::whole_element_field<3>(setup_.grid, setup_.part.expand(time.time));
    std::map<Index<3>, int> result;
    setup_.grid.all_elements().for_each([&](const Index<3>& element, std::int64_t offset) {
      result[element] = static_cast<int>(std::ceil(height * whole[offset] - 1e-9));
    });
    return result;
  }

  const Config config_;
  const fabseq::Setup<3> setup_{PETSC_COMM_WORLD, config_};
};

TEST_F(LayerRepairTest, ChangesTimesOfNodesWhereBeadsAreTooThick) {
  std::vector<double> nodal = planar_nodes();
  // Four elements become 1.18 high.
  disturb(nodal, {4, 4, 5}, 0.08);
  const PseudoTime<3> time = time_of(nodal);
  const auto result = repaired(time);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->changes.moved.empty());
  EXPECT_GE(result->changes.repaired, 1);
  const auto thickness = [](const PseudoTime<3>& of, std::size_t e) {
    const double* g = &of.gradient[3 * e];
    return 0.1 / std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  };
  double before = 0.0;
  for (std::size_t e = 0; e < time.time.size(); ++e) {
    before = std::max(before, thickness(time, e));
    EXPECT_LE(thickness(result->time, e), 1.15);
    EXPECT_GE(thickness(result->time, e), 0.8);
  }
  EXPECT_GT(max(setup_.grid.comm(), before), 1.15);
  // The gradient follows the changed times. Far from the place no time changes.
  const PseudoTime<3> same = time_of(result->time.nodal);
  EXPECT_EQ(same.time, result->time.time);
  EXPECT_EQ(same.gradient, result->time.gradient);
  setup_.grid.owned_nodes().for_each([&](const Index<3>& node, std::int64_t n) {
    if (std::abs(node[0] - 4) > 3) {
      EXPECT_EQ(result->time.nodal[n], nodal[n]);
    }
  });
}

TEST_F(LayerRepairTest, KeepsAGradientThatIsRecordedBesideTimes) {
  std::vector<double> nodal = planar_nodes();
  disturb(nodal, {4, 4, 5}, 0.08);
  PseudoTime<3> time = time_of(nodal);
  const auto expected = repaired(time);
  time.recorded_gradient = std::exchange(time.gradient, {});
  const auto result = repaired(time);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->time.gradient.empty());
  EXPECT_EQ(result->time.recorded_gradient, expected->time.gradient);
  EXPECT_EQ(result->time.time, expected->time.time);
  // Without any gradient thickness is an estimate, and times of nodes do not change it as they would.
  time.recorded_gradient.clear();
  (void)repaired(time);
}

TEST_F(LayerRepairTest, LetsWhatBeginsInTheAirWaitForWhatCarriesIt) {
  PseudoTime<3> time = planar_time(setup_.part, {});
  // What the element {4, 4, 4} could rest on comes two layers later.
  const std::vector<int>& elements = setup_.part.elements();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Index<3> at = setup_.grid.owned_elements().index(elements[e]);
    if (at[2] == 3 && std::abs(at[0] - 4) + std::abs(at[1] - 4) <= 1) time.time[e] += 0.2;
  }
  const auto result = repaired(time);
  ASSERT_TRUE(result);
  ASSERT_EQ(result->changes.moved.size(), 1U);
  EXPECT_EQ(result->changes.repaired, 1);
  EXPECT_EQ(result->changes.moved[0].element, (std::vector<int>{4, 4, 4}));
  EXPECT_EQ(result->changes.moved[0].from, 5);
  EXPECT_EQ(result->changes.moved[0].to, 6);
  const std::map<Index<3>, int> layer = layers_of(result->time);
  for (const auto& [at, own] : layer) {
    bool carried = at[2] == 0;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        if (const auto below = layer.find({at[0] + x, at[1] + y, at[2] - 1});
            below != layer.end() && std::abs(x) + std::abs(y) <= 1)
          carried = carried || below->second <= own;
    EXPECT_TRUE(carried) << at[0] << " " << at[1] << " " << at[2];
  }
}

TEST_F(LayerRepairTest, LeavesWhatIsRightOrFailsInTooManyPlaces) {
  EXPECT_FALSE(repaired(planar_time(setup_.part, {})));
  EXPECT_FALSE(repaired(time_of(planar_nodes())));
  std::vector<double> nodal = planar_nodes();
  for (int x = 1; x < width; x += 2) disturb(nodal, {x, x, 5}, 0.08);
  EXPECT_FALSE(repaired(time_of(nodal)));
}

class PlaceLimitTest : public LayerRepairTest {
 protected:
  PlaceLimitTest() : LayerRepairTest({{"tool.profile", "[[0.5, 0.2], [6, 4]]"}}) {}
};

TEST_F(PlaceLimitTest, CountsHaveTheDerivativesOfTheirDifferences) {
  std::vector<double> nodal = planar_nodes();
  // Wavy, so that no element is alike another.
  setup_.grid.owned_nodes().for_each([&](const Index<3>& node, std::int64_t n) {
    nodal[n] += 0.02 * std::sin(1.1 * node[0] + 0.7 * node[1] * node[1] + 0.9 * node[2]);
  });
  const auto layers = setup_.layers->make({}, 0.0, true, {});
  const auto at = [&](const std::vector<double>& times) { return cut<3>(setup_, *layers, time_of(times)); };
  std::vector<double> way;
  setup_.grid.owned_nodes().for_each([&](const Index<3>& node, std::int64_t) {
    way.push_back(std::cos(0.8 * node[0] - 1.3 * node[1] + 0.4 * node[2] * node[2]));
  });
  const auto moved = [&](double step) {
    std::vector<double> result = nodal;
    for (std::size_t n = 0; n < result.size(); ++n) result[n] += step * way[n];
    return at(result);
  };
  std::vector<double> marks(setup_.part.elements().size());
  for (std::size_t e = 0; e < marks.size(); ++e)
    marks[e] = setup_.grid.owned_elements().index(setup_.part.elements()[e])[0] % 2;
  for (const Fault fault : all_faults) {
    auto limit = PlaceLimit<3>::of(setup_, fault);
    ASSERT_TRUE(limit);
    limit->count(marks);
    (void)limit->value(at(nodal));
    TimeDerivatives derivatives;
    derivatives.time.assign(marks.size(), 0.0);
    derivatives.gradient.assign(3 * marks.size(), 0.0);
    limit->add_derivatives(at(nodal), derivatives);
    const ElementMatrices<3> element(setup_.grid.spacing(), 1.0, 0.0);
    const std::vector<double> gradient = pull_back_means<3>(setup_.part, element, {&derivatives, 1}).lane(0);
    const double slope =
        sum(setup_.grid.comm(), std::inner_product(gradient.begin(), gradient.end(), way.begin(), 0.0));
    constexpr double step = 1e-6;
    const double expected = (limit->value(moved(step)) - limit->value(moved(-step))) / (2.0 * step);
    EXPECT_NEAR(slope / expected, 1.0, 1e-5) << static_cast<int>(fault);
  }
}

}  // namespace
}  // namespace fabseq
