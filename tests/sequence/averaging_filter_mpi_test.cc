// SPDX-License-Identifier: MIT
/// The averaging filter against a double loop over all elements, and against its own transpose
/// (formulation 2.2).
#include "sequence/averaging_filter.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

/// In element edges 0.4 to 0.5: less than one, about two, across several ranks, the whole part, beyond all
/// indices.
const std::vector<double> radii = {0.2, 0.95, 1.3, 10.0, 1e12};

/// Weighted means by definition, on the whole grid; 0 outside the part.
template <int Dim>
std::vector<double> averages(const Part<Dim>& part, const std::vector<double>& field, double radius) {
  const Grid<Dim>& grid = part.grid();
  const auto inside = test::whole_part_field(part, std::vector<double>(part.elements().size(), 1.0));
  const auto values = test::whole_part_field(part, field);
  std::vector<double> result(values.size(), 0.0);
  for (std::size_t e = 0; e < values.size(); ++e) {
    double weights = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (inside[e] == 0.0 || inside[i] == 0.0) continue;
      const auto x = grid.element_center(grid.all_elements().index(e));
      const auto y = grid.element_center(grid.all_elements().index(i));
      double square = 0.0;
      for (int a = 0; a < Dim; ++a) square += (x[a] - y[a]) * (x[a] - y[a]);
      const double weight = std::max(0.0, radius - std::sqrt(square));
      weights += weight;
      result[e] += weight * values[i];
    }
    if (weights > 0.0) result[e] /= weights;
  }
  return result;
}

template <class T>
class AveragingFilterTest : public testing::Test {
 protected:
  static constexpr int Dim = T::value;
  const test::PartOnGrid<Dim> on_grid_{test::odd_domain<Dim>(), test::gallows<Dim>()};
  const Part<Dim>& part_ = on_grid_.part;
};
TYPED_TEST_SUITE(AveragingFilterTest, test::Dimensions);

TYPED_TEST(AveragingFilterTest, IsTheWeightedMeanOverThePart) {
  const auto field = test::noise_field(this->part_, 0.1, 2.0);
  for (const double radius : radii) {
    const AveragingFilter<TypeParam::value> filter(this->part_, radius);
    const auto filtered = test::whole_part_field(this->part_, filter.apply(field));
    EXPECT_LT(test::relative_difference(filtered, averages(this->part_, field, radius)), 1e-14) << radius;
  }
}

TYPED_TEST(AveragingFilterTest, KeepsConstants) {
  const std::vector<double> constant(this->part_.elements().size(), 0.7);
  for (const double radius : radii)
    for (const double value : AveragingFilter<TypeParam::value>(this->part_, radius).apply(constant))
      EXPECT_NEAR(value, 0.7, 1e-15);
}

TYPED_TEST(AveragingFilterTest, HasATranspose) {
  const auto x = test::noise_field(this->part_, -1.0, 1.0, 1);
  const auto y = test::noise_field(this->part_, -1.0, 1.0, 2);
  for (const double radius : radii) {
    const AveragingFilter<TypeParam::value> filter(this->part_, radius);
    EXPECT_NEAR(test::dot(filter.apply(x), y), test::dot(x, filter.apply_transpose(y)), 1e-13) << radius;
  }
}

TYPED_TEST(AveragingFilterTest, RadiusZeroIsTheIdentity) {
  const auto field = test::noise_field(this->part_, 0.0, 1.0);
  const AveragingFilter<TypeParam::value> filter(this->part_, 0.0);
  EXPECT_EQ(filter.apply(field), field);
  EXPECT_EQ(filter.apply_transpose(field), field);
}

}  // namespace
}  // namespace fabseq
