// SPDX-License-Identifier: MIT
/// The band solver and its numbering against dense matrices.
#include "multigrid/band_cholesky.h"

#include "multigrid/band_factor.h"
#include "support/brute_force.h"
#include "support/masked_box.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

/// A symmetric band matrix, dense; rows of very different size, strongly diagonal. The band is narrower in
/// the second half.
std::vector<double> band_matrix(int size, int bandwidth) {
  std::vector<double> matrix(static_cast<std::size_t>(size) * size, 0.0);
  const auto scale = [](int row) { return std::pow(10.0, -4.0 * test::noise(row, 6)); };
  for (int row = 0; row < size; ++row)
    for (int column = std::max(0, row - bandwidth); column <= row; ++column)
      if (row - column <= (column < size / 2 ? bandwidth : bandwidth / 3))
        matrix[row * size + column] = matrix[column * size + row] =
            scale(row) * scale(column) *
            (row == column ? 2.0 * (bandwidth + 1) : test::noise(row * size + column) - 0.5);
  return matrix;
}
BandCholesky filled(const std::vector<double>& matrix, int size, int bandwidth) {
  BandCholesky result;
  result.resize(size, bandwidth);
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column)
      if (std::abs(row - column) <= bandwidth)  // in two portions: they add up; the upper half does not count
        for (const double share : {0.25, 0.75}) result.add(row, column, share * matrix[row * size + column]);
  return result;
}

/// The largest error of a factor's solve, relative to the largest value.
template <class Real, int Width>
double error_of_factor(const BandCholesky& cholesky, const std::vector<double>& right,
                       const std::vector<double>& expected) {
  const std::size_t rows = BandFactor<Real>::padded(cholesky.size(), cholesky.bandwidth());
  LaneArray values(rows * Width, 0.0);
  std::copy(right.begin(), right.end(), values.begin());
  BandFactor<Real>(cholesky).template solve<Width>(values.data());
  for (std::size_t i = right.size(); i < values.size(); ++i) EXPECT_EQ(values[i], 0.0) << "behind the rows";
  values.resize(right.size());
  return test::relative_difference({values.begin(), values.end()}, expected);
}

TEST(BandCholeskyTest, SolvesLikeADenseMatrix) {
  for (const auto& [size, bandwidth] : std::vector<std::pair<int, int>>{
           {1, 0}, {7, 0}, {8, 3}, {40, 1}, {60, 13}, {64, 16}, {150, 70}, {20, 19}}) {
    const auto matrix = band_matrix(size, bandwidth);
    BandCholesky cholesky = filled(matrix, size, bandwidth);
    ASSERT_TRUE(cholesky.factor());
    test::for_each_width([&, size = size, bandwidth = bandwidth]<int Width>() {
      std::vector<double> expected, values(static_cast<std::size_t>(size) * Width, 0.0);
      for (int i = 0; i < size * Width; ++i) expected.push_back(test::noise(i, 2) - 0.5);
      for (int lane = 0; lane < Width; ++lane)
        for (int i = 0; i < size; ++i)
          for (int j = 0; j < size; ++j)
            values[i * Width + lane] += matrix[i * size + j] * expected[j * Width + lane];
      std::vector<double> one;
      for (int i = 0; i < size; ++i) one.push_back(values[i * Width]);
      EXPECT_LT((error_of_factor<double, Width>(cholesky, values, expected)), 1e-10) << size;
      EXPECT_LT((error_of_factor<float, Width>(cholesky, values, expected)), 1e-4) << size;
      cholesky.solve(one);
      for (int i = 0; i < size; ++i) EXPECT_NEAR(one[i], expected[i * Width], 1e-10);
    });
  }
}

TEST(BandCholeskyTest, EmptyRowsAreLeftAlone) {
  const int size = 30, bandwidth = 6;
  auto matrix = band_matrix(size, bandwidth);
  const std::set<int> empty = {0, 7, 8, 29};
  for (const int row : empty)
    for (int i = 0; i < size; ++i) matrix[row * size + i] = matrix[i * size + row] = 0.0;
  BandCholesky cholesky = filled(matrix, size, bandwidth);
  ASSERT_TRUE(cholesky.factor());
  std::vector<double> values(size, 0.0);
  for (int i = 0; i < size; ++i) {
    if (empty.count(i) != 0) values[i] = 3.0;
    for (int j = 0; j < size; ++j) values[i] += matrix[i * size + j] * (1.0 + j);
  }
  cholesky.solve(values);
  for (int i = 0; i < size; ++i) EXPECT_NEAR(values[i], empty.count(i) != 0 ? 3.0 : 1.0 + i, 1e-9);
}

TEST(BandCholeskyTest, SaysWhatIsNotPositiveDefinite) {
  const int size = 30, bandwidth = 6;
  auto matrix = band_matrix(size, bandwidth);
  EXPECT_TRUE(filled(matrix, size, bandwidth).factor());
  matrix[12 * size + 12] *= -1.0;
  EXPECT_FALSE(filled(matrix, size, bandwidth).factor());
}

TEST(BandCholeskyTest, CanBeUsedAgain) {
  BandCholesky cholesky = filled(band_matrix(20, 3), 20, 3);
  ASSERT_TRUE(cholesky.factor());
  cholesky.resize(4, 1);
  for (int i = 0; i < 4; ++i) cholesky.add(i, i, 2.0);
  ASSERT_TRUE(cholesky.factor());
  std::vector<double> values = {2.0, 4.0, 6.0, 8.0};
  cholesky.solve(values);
  for (int i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(values[i], 1.0 + i);
}

template <class T>
class BandNumberingTest : public testing::Test {};
TYPED_TEST_SUITE(BandNumberingTest, test::Dimensions);

TYPED_TEST(BandNumberingTest, IsAPermutationAndTheBandHoldsAllCouplings) {
  constexpr int Dim = TypeParam::value;
  for (const auto& box : test::masked_boxes<Dim>())
    for (const int components : {1, Dim}) {
      const LaneMesh<Dim> mesh(box.elements, box.active);
      const BandNumbering<Dim> numbering(mesh, components);
      const auto& rows = numbering.rows;
      ASSERT_EQ(static_cast<std::int64_t>(rows.size()), mesh.nodes() * components);
      std::vector<int> sorted = rows;
      std::sort(sorted.begin(), sorted.end());
      for (std::size_t i = 0; i < sorted.size(); ++i) EXPECT_EQ(sorted[i], static_cast<int>(i));
      int farthest = 0;
      box.for_each_active([&](const Index<Dim>& index, std::int64_t) {
        for (int i = 0; i < corner_count<Dim> * components; ++i)
          for (int j = 0; j < corner_count<Dim> * components; ++j) {
            const auto row = [&](int k) {
              return rows[mesh.node_number(box.corner_node(index, k / components)) * components +
                          k % components];
            };
            farthest = std::max(farthest, row(i) - row(j));
          }
      });
      EXPECT_EQ(numbering.bandwidth, farthest) << box.name;
    }
}

/// A beam has the band of its cross section, whichever way it lies.
TYPED_TEST(BandNumberingTest, RunsAlongTheLongestAxisLast) {
  constexpr int Dim = TypeParam::value;
  for (int longest = 0; longest < Dim; ++longest) {
    IndexBox<Dim> box;
    box.size.fill(2);
    box.size[longest] = 20;
    const LaneMesh<Dim> mesh(box, std::vector<char>(box.count(), 1));
    const int section = Dim == 2 ? 3 : 9;  // nodes; the farthest corner is one section and a node or four on
    const int expected = (section + (Dim == 2 ? 1 : 4)) * Dim + Dim - 1;
    EXPECT_EQ(BandNumbering<Dim>(mesh, Dim).bandwidth, expected) << longest;
  }
}

}  // namespace
}  // namespace fabseq
