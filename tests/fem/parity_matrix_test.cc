// SPDX-License-Identifier: MIT
/// Element matrices in the parity basis against those of brute force, and the bound of the scaled spectrum
/// against dense matrices.
#include "fabseq/base/error.h"
#include "fabseq/fem/parity.h"
#include "support/brute_force.h"
#include "support/masked_box.h"

#include <gtest/gtest.h>

#include <bit>
#include <vector>

namespace fabseq {
namespace {

template <int Dim>
std::vector<Point<Dim>> spacings() {
  if constexpr (Dim == 2)
    return {{1.0, 1.0}, {0.5, 0.3}, {2e-3, 7e-2}};
  else
    return {{1.0, 1.0, 1.0}, {0.4, 0.3, 0.5}, {2e-3, 7e-2, 1.3e-2}};
}
const std::vector<double> poisson_ratios = {0.0, 0.2, 0.3, 0.45};

template <int Dim>
std::vector<test::BruteForceElement<Dim>> elements() {
  std::vector<test::BruteForceElement<Dim>> result;
  for (const auto& spacing : spacings<Dim>())
    for (const double poisson : poisson_ratios) result.push_back({spacing, Dim == 2 ? 0.25 : 1.0, poisson});
  return result;
}
template <int Dim>
SquareMatrix<element_unknowns<Dim>> stiffness_of(const test::BruteForceElement<Dim>& element) {
  return element.template matrix<element_unknowns<Dim>>(
      [&](int i, int j) { return element.stiffness(i, j); });
}

/// K = sum over classes of modes^T block modes, written out.
template <int Dim, int Components>
std::vector<double> put_together(const ParityMatrix<Dim, Components>& parity) {
  using Parity = ParityMatrix<Dim, Components>;
  std::vector<double> matrix;
  const auto sign = [](int mode, int corner) {
    return std::popcount(static_cast<unsigned>(mode & corner)) % 2 == 0 ? 1.0 : -1.0;
  };
  for (int i = 0; i < Parity::unknowns; ++i)
    for (int j = 0; j < Parity::unknowns; ++j) {
      const int n = i / Components, a = i % Components, m = j / Components, b = j % Components;
      double& entry = matrix.emplace_back(0.0);
      for (int r = 0; r < Parity::classes; ++r)
        entry += sign(Parity::mode(r, a), n) * sign(Parity::mode(r, b), m) * parity.blocks[r][a][b];
    }
  return matrix;
}

template <class T>
class ParityMatrixTest : public testing::Test {};
TYPED_TEST_SUITE(ParityMatrixTest, test::Dimensions);

TYPED_TEST(ParityMatrixTest, BlocksReproduceTheStiffness) {
  constexpr int Dim = TypeParam::value;
  for (const auto& element : elements<Dim>()) {
    const auto stiffness = stiffness_of(element);
    const ParityMatrix<Dim, Dim> parity(stiffness);
    EXPECT_LT(test::relative_difference(put_together(parity), stiffness), 1e-13) << element.poisson;
  }
}

TYPED_TEST(ParityMatrixTest, BlocksReproduceConductivityAndMass) {
  constexpr int Dim = TypeParam::value;
  constexpr int corners = corner_count<Dim>;
  for (const auto& element : elements<Dim>()) {
    if (element.poisson > 0.0) continue;
    SquareMatrix<corners> lumped{};
    for (int n = 0; n < corners; ++n) lumped[n * corners + n] = 0.3;
    for (const auto& matrix :
         {element.template matrix<corners>([&](int i, int j) { return element.conductivity(i, j); }),
          element.template matrix<corners>([&](int i, int j) { return element.mass(i, j); }), lumped})
      EXPECT_LT(test::relative_difference(put_together(ParityMatrix<Dim, 1>(matrix)), matrix), 1e-13);
  }
}

/// Kernels leave out what does not couple, and nothing that does.
TYPED_TEST(ParityMatrixTest, CouplesSaysWhatVanishes) {
  constexpr int Dim = TypeParam::value;
  using Parity = ParityMatrix<Dim, Dim>;
  for (const auto& element : elements<Dim>()) {
    const Parity parity(stiffness_of(element));
    double scale = 0.0;
    for (const auto& block : parity.blocks)
      for (const auto& row : block) scale = std::max(scale, test::largest(row));
    for (int r = 0; r < Parity::classes; ++r)
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b) {
          const double size = std::abs(parity.blocks[r][a][b]) / scale;
          if (!Parity::couples(r, a, b)) {
            EXPECT_LT(size, 1e-14) << r << a << b;
          } else if (element.poisson > 0.0) {  // without it a stretch does not couple to one across
            EXPECT_GT(size, 1e-5) << r << a << b << " " << element.poisson;
          }
        }
  }
}

/// factor * D - K for a matrix K and the block diagonal D of its corner blocks: positive definite if and only
/// if all eigenvalues of D^-1 K are below the factor.
std::vector<double> distance_to_scaling(std::span<const double> matrix, int components, double factor) {
  std::vector<double> result(matrix.begin(), matrix.end());
  const int size = static_cast<int>(std::lround(std::sqrt(static_cast<double>(matrix.size()))));
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) {
      double& entry = result[static_cast<std::size_t>(i) * size + j];
      entry = (i / components == j / components ? factor * entry : 0.0) - entry;
    }
  return result;
}
/// The largest eigenvalue of D^-1 K, by bisection.
double largest_eigenvalue(std::span<const double> matrix, int components) {
  const int size = static_cast<int>(std::lround(std::sqrt(static_cast<double>(matrix.size()))));
  double low = 0.0, high = 1e3;
  while (high - low > 1e-12 * high) {
    const double middle = 0.5 * (low + high);
    (test::is_positive_definite(distance_to_scaling(matrix, components, middle), size) ? high : low) = middle;
  }
  return high;
}

TYPED_TEST(ParityMatrixTest, SpectrumBoundIsTheLargestEigenvalue) {
  constexpr int Dim = TypeParam::value;
  constexpr int corners = corner_count<Dim>;
  for (const auto& element : elements<Dim>()) {
    const auto stiffness = stiffness_of(element);
    EXPECT_NEAR(scaled_spectrum_bound(stiffness, corners, Dim) / largest_eigenvalue(stiffness, Dim), 1.0,
                1e-10);
    const auto conductivity =
        element.template matrix<corners>([&](int i, int j) { return element.conductivity(i, j); });
    EXPECT_NEAR(scaled_spectrum_bound(conductivity, corners, 1) / largest_eigenvalue(conductivity, 1), 1.0,
                1e-10);
  }
}

/// Cubes and a Poisson ratio of 0.3: 3.162 with node blocks, 5.3 with the diagonal only.
TEST(ScaledSpectrumBoundTest, KnownValues) {
  const auto cube = stiffness_of(test::BruteForceElement<3>{{0.1, 0.1, 0.1}, 1.0, 0.3});
  EXPECT_NEAR(scaled_spectrum_bound(cube, 8, 3), 3.162, 5e-4);
  EXPECT_NEAR(scaled_spectrum_bound(cube, 24, 1), 5.3, 0.05);
}

TEST(ScaledSpectrumBoundTest, RefusesAMatrixWithoutCornerBlocks) {
  const SquareMatrix<8> zero{};
  EXPECT_THROW((void)scaled_spectrum_bound(zero, 4, 2), NumericalError);
}

/// Holds for any stiffness of the elements, with elements missing.
TYPED_TEST(ParityMatrixTest, SpectrumBoundHoldsForAssembledMatrices) {
  constexpr int Dim = TypeParam::value;
  IndexBox<Dim> box;
  box.size.fill(Dim == 2 ? 6 : 3);
  for (const auto& mask : test::masks<Dim>()) {
    const test::MaskedBox<Dim> part(box, mask);
    const auto touched = part.touching_elements();
    std::vector<int> numbers(touched.size(), -1);
    int nodes = 0;
    for (std::size_t node = 0; node < touched.size(); ++node)
      if (touched[node] > 0) numbers[node] = nodes++;
    if (nodes == 0) continue;
    for (const double poisson : {0.3, 0.45}) {
      const auto stiffness = stiffness_of(test::BruteForceElement<Dim>{spacings<Dim>()[1], 1.0, poisson});
      const double bound = scaled_spectrum_bound(stiffness, corner_count<Dim>, Dim);
      const int size = nodes * Dim;
      std::vector<double> matrix(static_cast<std::size_t>(size) * size, 0.0);
      part.for_each_active([&](const Index<Dim>& index, std::int64_t offset) {
        const auto unknown = [&](int i) {
          return numbers[part.nodes.offset(part.corner_node(index, i / Dim))] * Dim + i % Dim;
        };
        for (int i = 0; i < element_unknowns<Dim>; ++i)
          for (int j = 0; j < element_unknowns<Dim>; ++j)
            matrix[static_cast<std::size_t>(unknown(i)) * size + unknown(j)] +=
                test::wild_factor(offset, 0) * stiffness[i * element_unknowns<Dim> + j];
      });
      // Rows of very different size are brought to 1: definiteness stays, rounding does not spoil it.
      auto distance = distance_to_scaling(matrix, Dim, bound * (1.0 + 1e-9));
      for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
          distance[static_cast<std::size_t>(i) * size + j] /=
              std::sqrt(matrix[static_cast<std::size_t>(i) * (size + 1)] *
                        matrix[static_cast<std::size_t>(j) * (size + 1)]);
      EXPECT_TRUE(test::is_positive_definite(distance, size)) << mask.name << " " << poisson;
    }
  }
}

}  // namespace
}  // namespace fabseq
