/// The matrix-free operator against sums over the elements one by one.
#include "fabseq/fem/lane_sweep.h"

#include "fabseq/fem/element_matrices.h"

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/masked_box.h"
#include <algorithm>
#include <vector>

namespace fabseq {
namespace {

/// Relative to the size of the terms that are summed up at a node.
constexpr double rounding = 2e-15;

template <int Dim>
Point<Dim> spacing() {
  Point<Dim> result{};
  for (int axis = 0; axis < Dim; ++axis) result[axis] = 0.5 - 0.1 * axis;
  return result;
}
template <int Dim>
test::BruteForceElement<Dim> brute_force() {
  return {spacing<Dim>(), Dim == 2 ? 0.25 : 1.0, 0.3};
}
template <int Dim>
ElementMatrices<Dim> library() {
  return ElementMatrices<Dim>(spacing<Dim>(), Dim == 2 ? 0.25 : 1.0, 0.3);
}

/// Another stiffness in every lane and element.
template <int Dim_>
struct Elasticity {
  static constexpr int Dim = Dim_;
  static constexpr int components = Dim;
  template <int Width>
  using Kernel = ElasticKernel<Dim, Width>;

  template <int Width>
  std::vector<double> coefficients(const test::MaskedBox<Dim>& box) const {
    std::vector<double> result;
    box.for_each_active([&](const Index<Dim>&, std::int64_t offset) {
      for (int lane = 0; lane < Width; ++lane) result.push_back(test::wild_factor(offset, lane));
    });
    return result;
  }
  template <int Width>
  Kernel<Width> kernel(const std::vector<double>& coefficients) const {
    return {parity, coefficients.data()};
  }
  std::vector<double> element_matrix(std::int64_t offset, int lane) const {
    std::vector<double> result = matrix;
    for (double& entry : result) entry *= test::wild_factor(offset, lane);
    return result;
  }

  ParityMatrix<Dim, Dim> parity{library<Dim>().stiffness()};
  std::vector<double> matrix = [] {
    const auto entries = brute_force<Dim>().template matrix<element_unknowns<Dim>>(
        [](int i, int j) { return brute_force<Dim>().stiffness(i, j); });
    return std::vector<double>(entries.begin(), entries.end());
  }();
};

/// One operator for all lanes.
template <int Dim_>
struct Heat {
  static constexpr int Dim = Dim_;
  static constexpr int components = 1;
  static constexpr int corners = corner_count<Dim>;
  template <int Width>
  using Kernel = HeatKernel<Dim, Width>;

  static double reaction(std::int64_t offset) { return 10.0 * test::noise(offset, 3); }
  template <int Width>
  std::vector<double> coefficients(const test::MaskedBox<Dim>& box) const {
    std::vector<double> result;
    box.for_each_active([&](const Index<Dim>&, std::int64_t offset) {
      result.push_back(test::wild_factor(offset, 0));
      result.push_back(reaction(offset));
    });
    return result;
  }
  template <int Width>
  Kernel<Width> kernel(const std::vector<double>& coefficients) const {
    return {conductivity_parity, mass_parity, coefficients.data()};
  }
  std::vector<double> element_matrix(std::int64_t offset, int) const {
    std::vector<double> result(conductivity.size());
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = test::wild_factor(offset, 0) * conductivity[i] + reaction(offset) * mass[i];
    return result;
  }

  ParityMatrix<Dim, 1> conductivity_parity{library<Dim>().conductivity()};
  ParityMatrix<Dim, 1> mass_parity{library<Dim>().consistent_mass()};
  SquareMatrix<corners> conductivity = brute_force<Dim>().template matrix<corners>(
      [](int i, int j) { return brute_force<Dim>().conductivity(i, j); });
  SquareMatrix<corners> mass =
      brute_force<Dim>().template matrix<corners>([](int i, int j) { return brute_force<Dim>().mass(i, j); });
};

/// A box, its mesh, and vectors on both. Values at nodes differ by many decades, too.
template <class Physics, int Width>
struct Sweep {
  static constexpr int Dim = Physics::Dim;
  static constexpr int components = Physics::components;
  static constexpr int block = components * Width;

  explicit Sweep(const test::MaskedBox<Dim>& box_)
      : box(box_),
        mesh(box.elements, box.active),
        coefficients(physics.template coefficients<Width>(box)),
        window(mesh.window() * block, 0.0) {
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
  using Values = std::array<Lanes<Width>, components>;
  /// `finish` and the sums of shared nodes.
  template <class Finish>
  std::vector<double> run(Finish&& finish, std::size_t shared_nodes = 0) {
    std::vector<double> shared(shared_nodes * block, NAN);
    sweep(mesh, physics.template kernel<Width>(coefficients), x.data(), window.data(), shared.data(), finish);
    for (const double value : window) EXPECT_EQ(value, 0.0) << "the window is not clean";
    return shared;
  }
  /// K x of the nodes that are not shared; NaN at the others.
  std::vector<double> product() {
    std::vector<double> result(x.size(), NAN);
    run([&](std::int64_t node, const Values& sums) {
      for (int a = 0; a < components; ++a) {
        EXPECT_TRUE(std::isnan(result[node * block + a * Width])) << "a node twice";
        sums[a].store(&result[node * block + a * Width]);
      }
    });
    return result;
  }

  const test::MaskedBox<Dim>& box;
  Physics physics;
  LaneMesh<Dim> mesh;
  std::vector<double> coefficients, window, x;
  std::vector<std::vector<double>> plain;  ///< x, [lane][unknown of the box]
};

template <class T>
class LaneSweepTest : public testing::Test {};
using AllPhysics = testing::Types<Elasticity<2>, Elasticity<3>, Heat<2>, Heat<3>>;
TYPED_TEST_SUITE(LaneSweepTest, AllPhysics);

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

TYPED_TEST(LaneSweepTest, XCanBeOverwritten) {
  for (const auto& box : test::masked_boxes<TypeParam::Dim>())
    test::for_each_width([&]<int Width>() {
      Sweep<TypeParam, Width> lanes(box);
      const auto expected = lanes.product();
      using Values = typename Sweep<TypeParam, Width>::Values;
      lanes.run([&](std::int64_t node, const Values& sums) {
        for (int a = 0; a < TypeParam::components; ++a)
          sums[a].store(&lanes.x[node * lanes.block + a * Width]);
      });
      EXPECT_EQ(lanes.x, expected) << box.name << " " << Width;
    });
}

TYPED_TEST(LaneSweepTest, SharedNodesComeApart) {
  for (const auto& box : test::masked_boxes<TypeParam::Dim>()) {
    Sweep<TypeParam, 4> lanes(box);
    const auto expected = lanes.product();
    std::vector<std::int64_t> nodes;
    for (std::int64_t node = 0; node < lanes.mesh.nodes(); ++node)
      if (test::noise(node, 8) < 0.4) nodes.push_back(node);
    lanes.mesh.set_shared(nodes);
    std::vector<double> product(expected.size(), NAN);
    using Values = typename Sweep<TypeParam, 4>::Values;
    const auto shared = lanes.run(
        [&](std::int64_t node, const Values& sums) {
          EXPECT_FALSE(std::binary_search(nodes.begin(), nodes.end(), node));
          for (int a = 0; a < TypeParam::components; ++a) sums[a].store(&product[node * lanes.block + a * 4]);
        },
        nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      std::copy_n(&shared[i * lanes.block], lanes.block, &product[nodes[i] * lanes.block]);
    EXPECT_EQ(product, expected) << box.name;
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
