// SPDX-License-Identifier: MIT
/// What stands before the first layer, and what is held (formulation 4.4).
#include "fabseq/machine/interior_extrema.h"
#include "fabseq/part/substrate.h"
#include "fabseq/part/supports.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "fabseq/sequence/given_sequence.h"
#include "sequence/heat_sequence.h"
#include "support/refusal.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fabseq {
namespace {

using test::box;

/// A wall of one element on a base plate of two layers in the middle of the box, 9 x 4 x 6 unit cubes less
/// half of x.
const Domain<3> domain{{4.5, 4.0, 6.0}, {9, 4, 6}, 1.0};
const BuildPlate bottom{2, false};

PartDescription wall() {
  PartDescription description{box({1, 1, 1}, {3.5, 2, 6}),
                              false};  // reaches into the substrate, which has precedence
  description.substrate = box({0, 0, 1}, {4.5, 4, 3});
  return description;
}

std::int64_t count(const std::vector<char>& marks) {
  std::int64_t result = 0;
  for (const char mark : marks) result += mark;
  return sum(PETSC_COMM_WORLD, result);
}

std::string supports_refusal(const PartDescription& description) {
  return test::refusal([&] {
    const test::PartOnGrid<3> on_grid(domain, description, bottom);
    const Supports<3> supports(on_grid.part, description);
  });
}

TEST(SubstrateTest, ItsElementsAreNoPart) {
  const test::PartOnGrid<3> on_grid(domain, wall(), bottom);
  const Part<3>& part = on_grid.part;
  EXPECT_EQ(part.substrate().count(), 9 * 4 * 2);
  EXPECT_EQ(count(part.substrate().elements()), 9 * 4 * 2);
  EXPECT_EQ(count(part.substrate().nodes()), 10 * 5 * 3);
  EXPECT_EQ(part.count(), 5 * 1 * 3);
  EXPECT_DOUBLE_EQ(part.volume(), 2.5 * 1 * 3);
  EXPECT_EQ(part.plate_contact(), 5);
  EXPECT_EQ(part.lower(), (Point<3>{1.0, 1.0, 3.0}));
  for (std::size_t e = 0; e < part.elements().size(); ++e) {
    const Index<3> index = part.grid().owned_elements().index(part.elements()[e]);
    EXPECT_EQ(part.contact_distance()[e], index[2] == 3 ? 0.5 : INFINITY);
  }
}

TEST(SubstrateTest, LayersStartFromIt) {
  const test::PartOnGrid<3> on_grid(domain, wall(), bottom);
  const Part<3>& part = on_grid.part;
  const auto distance = geodesic_distance(part);
  const auto time = planar_time(part, {});
  for (std::size_t e = 0; e < distance.size(); ++e) {
    const double height =
        part.grid().element_center(part.grid().owned_elements().index(part.elements()[e]))[2] - 3.0;
    EXPECT_NEAR(distance[e], height, 1e-12);
    EXPECT_NEAR(time.time[e], height / 3.0, 1e-12);
  }
  EXPECT_NEAR(geodesic_height(part, distance), 3.0, 1e-12);
  EXPECT_EQ(count_interior_minima<3>(part, time.time), 0);
  const HeatModel<3> heat(part, {});
  EXPECT_EQ(count(heat.domain.fixed), 10 * 5 * 3);
}

/// Contact may be sideways, across a spacing of its own.
TEST(SubstrateTest, PartsMayStandOnItsSide) {
  PartDescription description{box({2, 0, 0}, {4.5, 1, 1}), false};
  description.substrate = box({0, 0, 0}, {2, 4, 6});
  const test::PartOnGrid<3> on_grid(domain, description, BuildPlate{2, true});
  EXPECT_EQ(on_grid.part.plate_contact(), 1);
  const auto distance = geodesic_distance(on_grid.part);
  for (std::size_t e = 0; e < distance.size(); ++e) {
    const Index<3> index = on_grid.grid.owned_elements().index(on_grid.part.elements()[e]);
    EXPECT_NEAR(distance[e], 0.25 + 0.5 * (index[0] - 4), 1e-12);
  }
}

TEST(SubstrateTest, ItsSideTowardsThePlateIsHeldWithoutClamps) {
  const test::PartOnGrid<3> on_grid(domain, wall(), bottom);
  const Supports<3> supports(on_grid.part, on_grid.description);
  EXPECT_EQ(supports.pieces, 1);
  EXPECT_EQ(count(supports.held), 10 * 5);
  on_grid.grid.owned_nodes().for_each([&](const Index<3>& node, std::int64_t offset) {
    EXPECT_EQ(supports.held[offset] != 0, node[2] == 1);
  });
  EXPECT_EQ(sum(PETSC_COMM_WORLD, static_cast<std::int64_t>(supports.holding.size())), 10 * 5);
}

TEST(SubstrateTest, ClampsTakeThePlaceOfThePlate) {
  PartDescription description = wall();
  description.clamps = box({0, 0, 0}, {0, 4, 2});  // its lowest nodes hold nothing
  const test::PartOnGrid<3> on_grid(domain, description, bottom);
  const Supports<3> supports(on_grid.part, description);
  EXPECT_EQ(count(supports.held), 5 * 3);
  EXPECT_EQ(sum(PETSC_COMM_WORLD, static_cast<std::int64_t>(supports.holding.size())), 5 * 2);

  PartDescription without{box({0, 0, 0}, {4.5, 1, 6}), false};
  without.clamps = box({0, 0, 0}, {0, 4, 6});
  const test::PartOnGrid<3> wall_on_plate(domain, without, bottom);
  EXPECT_EQ(count(Supports<3>(wall_on_plate.part, without).held), 5 * 7);
}

TEST(SubstrateTest, RefusesWhatCannotStand) {
  PartDescription nothing = wall();
  nothing.substrate = box({0, 0, 9}, {1, 1, 10});
  EXPECT_EQ(supports_refusal(nothing),
            "/substrate: no element's centre in the domain lies inside the shape; needs at least one");
  PartDescription covered = wall();
  covered.substrate = box({0, 0, 0}, {4.5, 4, 6});
  EXPECT_NE(supports_refusal(covered).find("/part: no element has a density above 0"), std::string::npos);
  EXPECT_NE(supports_refusal(covered).find("outside the substrate"), std::string::npos);
  PartDescription apart = wall();
  apart.source = box({1, 1, 4}, {3.5, 2, 6});
  EXPECT_NE(supports_refusal(apart).find(
                "/build_plate: no element of the part has a face on the build plate z- or on "
                "the substrate"),
            std::string::npos);
  PartDescription nowhere = wall();
  nowhere.clamps = box({0, 0, 5}, {0, 4, 6});
  EXPECT_EQ(supports_refusal(nowhere),
            "/clamps: no node of part or substrate lies in or on the shape; needs at least 3");
}

TEST(SubstrateTest, RefusesClampsThatLeaveAMotionFree) {
  const std::string free =
      " leave a rigid motion of part and substrate free; needed: nodes that hold every "
      "face-connected piece of them";
  PartDescription line = wall();
  line.clamps = box({0, 0, 1}, {0, 4, 1});  // may turn about it
  EXPECT_EQ(supports_refusal(line), "/clamps: the clamped nodes" + free);
  PartDescription two = wall();
  two.substrate = test::union_of({box({0, 0, 1}, {4.5, 4, 3}), box({0, 0, 4}, {0.5, 4, 6})});
  two.clamps = box({0, 0, 1}, {0, 4, 2});
  EXPECT_EQ(
      supports_refusal(two),
      "/clamps: the clamped nodes leave a rigid motion of a piece of 8 elements of part and substrate free; "
      "needed: nodes that hold every face-connected piece of them");
}

}  // namespace
}  // namespace fabseq
