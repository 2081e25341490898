// SPDX-License-Identifier: MIT
/// The matrix-free operator against sums over the elements one by one.
#include "kernels/lane_sweep.h"

#include "fabseq/fem/element_matrices.h"
#include "support/lane_physics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

namespace fabseq {
namespace {

/// Relative to the size of the terms that are summed up at a node.
constexpr double rounding = 2e-15;

/// A box, its mesh, and vectors on both. Values at nodes differ by many decades, too.
template <class Physics, int Width>
struct Sweep {
  static constexpr int Dim = Physics::Dim;
  static constexpr int components = Physics::components;
  static constexpr int block = components * Width;
  using Kernel = typename Physics::Problem::template Kernel<Width>;

  explicit Sweep(const test::MaskedBox<Dim>& box_)
      : box(box_), mesh(box.elements, box.active), window(mesh.window() * block, 0.0) {
    box.for_each_active([&](const Index<Dim>&, std::int64_t element) {
      for (int entry = 0; entry < Kernel::stride; ++entry)
        coefficients.push_back(Physics::coefficient(element, entry));
    });
    for (int lane = 0; lane < Width; ++lane) {
      auto& values = plain.emplace_back();
      for (std::int64_t i = 0; i < box.nodes.count() * components; ++i)
        values.push_back((test::noise(i, 2 * lane) - 0.5) * std::pow(10.0, -6.0 * test::noise(i, 9)));
    }
    x.resize(mesh.nodes() * block);
    for_each_value([&](std::size_t at, std::size_t unknown, int lane) { x[at] = plain[lane][unknown]; });
  }

  /// f(place in a lane vector, unknown of the box, lane).
  template <class Function>
  void for_each_value(Function&& f) const {
    box.nodes.for_each([&](const Index<Dim>& node, std::int64_t offset) {
      const std::int64_t number = mesh.node_number(node);
      for (int i = 0; number >= 0 && i < block; ++i)
        f(number * block + i, offset * components + i / Width, i % Width);
    });
  }
  /// `count` values of each component, of a node or of several side by side, which `store` puts in their
  /// places.
  struct Sums {
    std::int64_t node;
    int count;
    std::array<const double*, components> values;

    void store(std::vector<double>& vector) const {
      for (int a = 0; a < components; ++a) std::copy_n(values[a], count, &vector[node * block + a * Width]);
    }
    /// Whether their places in the vector hold no numbers yet.
    bool are_new(const std::vector<double>& vector) const {
      for (int a = 0; a < components; ++a) {
        const double* const place = &vector[node * block + a * Width];
        if (!std::all_of(place, place + count, [](double value) { return std::isnan(value); })) return false;
      }
      return true;
    }
  };
  /// `finish`, and the sums of shared nodes. One type of `finish`: each compiles the sweep anew.
  std::vector<double> run(const std::function<void(const Sums&)>& finish, std::size_t shared_nodes = 0) {
    std::vector<double> shared(shared_nodes * block, NAN);
    const Kernel kernel = Physics::Problem::template kernel<Width>(physics.matrices, coefficients.data());
    sweep(mesh, kernel, x.data(), window.data(), shared.data(),
          [&]<class Sum>(std::int64_t node, const std::array<Sum, components>& sums) {
            std::array<double, components * Sum::width> stored;
            Sums all{node, Sum::width, {}};
            for (int a = 0; a < components; ++a) {
              sums[a].store(&stored[a * Sum::width]);
              all.values[a] = &stored[a * Sum::width];
            }
            finish(all);
          });
    for (const double value : window) EXPECT_EQ(value, 0.0) << "the window is not clean";
    return shared;
  }
  /// K x of the nodes that are not shared; NaN at the others.
  std::vector<double> product() {
    std::vector<double> result(x.size(), NAN);
    run([&](const Sums& sums) {
      EXPECT_TRUE(sums.are_new(result)) << "a node twice";
      sums.store(result);
    });
    return result;
  }

  const test::MaskedBox<Dim>& box;
  Physics physics;
  LaneMesh<Dim> mesh;
  std::vector<double> coefficients, window, x;
  std::vector<std::vector<double>> plain;  ///< x, [lane][unknown of the box]
};

/// Relative to the largest value; compilers round sweeps that do different things with the sums differently.
double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i])) return INFINITY;
    difference = std::max(difference, std::abs(a[i] - b[i]));
    size = std::max(size, std::abs(b[i]));
  }
  if (a.size() != b.size()) return INFINITY;
  return difference == 0.0 ? 0.0 : difference / size;
}

template <class T>
class LaneSweepTest : public testing::Test {};
TYPED_TEST_SUITE(LaneSweepTest, test::AllPhysics);

TYPED_TEST(LaneSweepTest, AgreesWithPlainSums) {
  for (const auto& box : test::masked_boxes<TypeParam::Dim>())
    test::for_each_width([&]<int Width>() {
      Sweep<TypeParam, Width> lanes(box);
      const auto product = lanes.product();
      std::vector<test::PlainProduct> expected;
      for (int lane = 0; lane < Width; ++lane)
        expected.push_back(test::multiply(
            box, TypeParam::components,
            [&](std::int64_t offset) { return lanes.physics.element_matrix(offset, lane); },
            lanes.plain[lane]));
      double worst = 0.0;
      lanes.for_each_value([&](std::size_t at, std::size_t unknown, int lane) {
        const double error = std::abs(product[at] - expected[lane].value[unknown]) /
                             expected[lane].scale[unknown / TypeParam::components];
        worst = std::isfinite(error) ? std::max(worst, error) : INFINITY;
      });
      EXPECT_LT(worst, rounding) << box.name << " " << Width;
    });
}

/// Of K x in single precision, relative to the largest terms: it is differences of what is rounded.
template <class Physics, int Width>
double rounding_error(const test::MaskedBox<Physics::Dim>& box) {
  constexpr int components = Physics::components;
  Sweep<Physics, Width> lanes(box);
  std::vector<double> expected = lanes.product(), terms = expected;
  const std::vector<float> x(lanes.x.begin(), lanes.x.end());
  const std::vector<float> coefficients(lanes.coefficients.begin(), lanes.coefficients.end());
  std::vector<float> window(lanes.window.size(), 0.0F);
  const auto kernel = Physics::Problem::template kernel<Width>(lanes.physics.matrices, coefficients.data());
  std::vector<test::PlainProduct> plain;
  for (int lane = 0; lane < Width; ++lane)
    plain.push_back(test::multiply(
        box, components, [&](std::int64_t offset) { return lanes.physics.element_matrix(offset, lane); },
        lanes.plain[lane]));
  lanes.for_each_value([&](std::size_t at, std::size_t unknown, int lane) {
    terms[at] = plain[lane].scale[unknown / components];
  });
  double worst = 0.0;
  sweep(lanes.mesh, kernel, x.data(), window.data(), static_cast<float*>(nullptr),
        [&]<class Sum>(std::int64_t node, const std::array<Sum, components>& sums) {
          for (int i = 0; i < components * Sum::width; ++i) {
            const std::size_t at = node * lanes.block + i;
            const float sum = sums[i / Sum::width][i % Sum::width];
            worst = std::max(worst, std::abs(sum - expected[at]) / terms[at]);
          }
        });
  return worst;
}

TYPED_TEST(LaneSweepTest, SinglePrecisionAgreesToItsOwnRounding) {
  for (const auto& box : test::masked_boxes<TypeParam::Dim>())
    test::for_each_width([&]<int Width>() {
      EXPECT_LT((rounding_error<TypeParam, Width>(box)), 1e-6) << box.name << " " << Width;
    });
}

template <class Physics, int Width>
void expect_x_can_be_overwritten(const test::MaskedBox<Physics::Dim>& box) {
  Sweep<Physics, Width> lanes(box);
  const auto expected = lanes.product();
  lanes.run([&](const auto& sums) { sums.store(lanes.x); });
  EXPECT_LT(largest_difference(lanes.x, expected), rounding) << box.name << " " << Width;
}

TYPED_TEST(LaneSweepTest, XCanBeOverwritten) {
  for (const auto& box : test::masked_boxes<TypeParam::Dim>()) {
    expect_x_can_be_overwritten<TypeParam, 1>(box);
    expect_x_can_be_overwritten<TypeParam, 4>(box);
  }
}

template <class Physics, int Width>
void expect_shared_nodes_apart(const test::MaskedBox<Physics::Dim>& box) {
  Sweep<Physics, Width> lanes(box);
  const auto expected = lanes.product();
  std::vector<std::int64_t> nodes;
  for (std::int64_t node = 0; node < lanes.mesh.nodes(); ++node)
    if (test::noise(node, 8) < 0.4) nodes.push_back(node);
  lanes.mesh.set_shared(nodes);
  std::vector<double> product(expected.size(), NAN);
  const auto shared = lanes.run(
      [&](const auto& sums) {
        const auto next = std::lower_bound(nodes.begin(), nodes.end(), sums.node);
        EXPECT_TRUE(next == nodes.end() || *next >= sums.node + sums.count / Width);
        sums.store(product);
      },
      nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    std::copy_n(&shared[i * lanes.block], lanes.block, &product[nodes[i] * lanes.block]);
  EXPECT_LT(largest_difference(product, expected), rounding) << box.name << " " << Width;
}

TYPED_TEST(LaneSweepTest, SharedNodesComeApart) {
  for (const auto& box : test::masked_boxes<TypeParam::Dim>()) {
    expect_shared_nodes_apart<TypeParam, 1>(box);
    expect_shared_nodes_apart<TypeParam, 4>(box);
  }
}

/// Not a number in one lane of one node: no other lane notices.
TYPED_TEST(LaneSweepTest, LanesDoNotTouchEachOther) {
  for (const auto& box : test::masked_boxes<TypeParam::Dim>()) {
    Sweep<TypeParam, 8> lanes(box);
    const auto expected = lanes.product();
    for (std::size_t i = 5; i < lanes.x.size(); i += 8) lanes.x[i] = NAN;
    const auto product = lanes.product();
    for (std::size_t i = 0; i < product.size(); ++i)
      EXPECT_TRUE(i % 8 == 5 ? std::isnan(product[i]) : product[i] == expected[i]) << box.name;
  }
}

}  // namespace
}  // namespace fabseq
