// SPDX-License-Identifier: MIT
/// Mutual energies and works of elements against the matrices (docs/developer/derivatives.md 8.2).
#include "kernels/element_energy.h"

#include "kernels/lanes.h"
#include "support/brute_force.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fabseq {
namespace {

constexpr double poisson = 0.27;

/// Some elements of a box, with and without a neighbour before them, and fields on its nodes.
template <int Dim>
struct Case {
  Case() {
    if constexpr (Dim == 2) {
      size = {5, 3};
      spacing = {0.7, 1.9};
    } else {
      size = {5, 3, 4};
      spacing = {0.7, 1.9, 0.4};
    }
    const IndexBox<Dim> nodes{{}, size};
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      Index<Dim> at{};
      for (int a = 0; a < Dim; ++a) at[a] = (corner >> a) & 1;
      corner_offsets[corner] = static_cast<int>(nodes.offset(at));
    }
    nodes.for_each([&](const Index<Dim>& node, std::int64_t number) {
      bool inside = true;
      for (int a = 0; a < Dim; ++a) inside = inside && node[a] + 1 < size[a];
      if (inside && test::noise(number, 5) < 0.7) first_corners.push_back(static_cast<int>(number));
    });
    node_count = static_cast<int>(nodes.count());
  }
  /// [node][component][lane].
  std::vector<double> field(int lanes, int salt) const {
    std::vector<double> result(static_cast<std::size_t>(node_count) * Dim * lanes);
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = test::noise(static_cast<std::int64_t>(i), salt) - 0.4;
    return result;
  }
  /// Position of an element's unknown in a field.
  std::size_t position(int e, int unknown, int lanes, int lane) const {
    const std::size_t node = first_corners[e] + corner_offsets[unknown / Dim];
    return (node * Dim + unknown % Dim) * lanes + lane;
  }

  Index<Dim> size;
  Point<Dim> spacing;
  std::array<int, corner_count<Dim>> corner_offsets{};
  std::vector<int> first_corners;
  int node_count = 0;
};

template <class T>
class ElementEnergyTest : public testing::Test {};
TYPED_TEST_SUITE(ElementEnergyTest, test::Dimensions);

/// Lanes that are chunks of 8, 4, 2, 1 and sums of these.
TYPED_TEST(ElementEnergyTest, AgreesWithBruteForce) {
  constexpr int Dim = TypeParam::value;
  constexpr int unknowns = element_unknowns<Dim>;
  const Case<Dim> the;
  const double thickness = Dim == 2 ? 0.35 : 1.0;
  const test::BruteForceElement<Dim> exact{the.spacing, thickness, poisson};
  const ElementMatrices<Dim> element(the.spacing, thickness, poisson);
  const auto strain = test::some_strain<Dim>();
  const ParityMatrix<Dim, Dim> parity(element.stiffness());
  const auto load = element.strain_load(strain);
  const auto matrix = exact.template matrix<unknowns>([&](int i, int j) { return exact.stiffness(i, j); });
  for (const int lanes : {1, 2, 3, 4, 7, 8, 11}) {
    const auto u = the.field(lanes, 1), lambda = the.field(lanes, 2);
    const std::size_t count = the.first_corners.size();
    std::vector<double> mutual(count * lanes, std::nan("")), work(count * lanes, std::nan(""));
    for_lane_chunks(lanes, [&]<int Width>(int first) {
      const ElementEnergy<Dim, Width> energy(parity, load);
      energy.for_each(the.first_corners, the.corner_offsets, &u[first], &lambda[first], lanes,
                      [&](std::size_t e, const auto& of_element) {
                        of_element.mutual.store(&mutual[e * lanes + first]);
                        of_element.work.store(&work[e * lanes + first]);
                      });
    });
    for (std::size_t e = 0; e < count; ++e)
      for (int lane = 0; lane < lanes; ++lane) {
        double expected = 0.0, expected_work = 0.0;
        for (int i = 0; i < unknowns; ++i) {
          const double value = lambda[the.position(e, i, lanes, lane)];
          for (int j = 0; j < unknowns; ++j)
            expected += value * matrix[i * unknowns + j] * u[the.position(e, j, lanes, lane)];
          expected_work += value * exact.strain_load(i, test::strain_tensor<Dim>(strain));
        }
        EXPECT_NEAR(mutual[e * lanes + lane], expected, 1e-12) << e << ' ' << lane << " of " << lanes;
        EXPECT_NEAR(work[e * lanes + lane], expected_work, 1e-13) << e << ' ' << lane << " of " << lanes;
      }
  }
}

TEST(LaneChunks, CoverEachLaneOnceAndInOrder) {
  for (int lanes = 0; lanes <= 19; ++lanes) {
    int next = 0, chunks = 0;
    for_lane_chunks(lanes, [&]<int Width>(int first) {
      EXPECT_EQ(first, next);
      next += Width;
      ++chunks;
    });
    EXPECT_EQ(next, lanes);
    EXPECT_LE(chunks, lanes / 8 + 3);
  }
}

}  // namespace
}  // namespace fabseq
