// SPDX-License-Identifier: MIT
/// A part field on a grid twice as fine: linear ones stay what they are, and nothing from outside enters.
#include "fabseq/sequence/refined_field.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <int Dim>
Domain<Dim> finer(Domain<Dim> domain) {
  for (int& elements : domain.elements) elements *= 2;
  return domain;
}

/// A block with a round hole, whose stairs on the fine grid are not those of the coarse one.
template <int Dim>
struct HoledBlock {
  static Domain<Dim> domain() {
    if constexpr (Dim == 2)
      return {{3.6, 2.4}, {12, 9}, 0.25};
    else
      return {{3.6, 2.4, 3.0}, {9, 8, 7}, 1.0};
  }
  static Shape shape() {
    const auto size = domain().size;
    Shape hole;
    hole.kind = Shape::Kind::sphere;
    for (int axis = 0; axis < Dim; ++axis) hole.first.push_back(0.55 * size[axis]);
    hole.radius = 0.45;  // leaves walls two elements thick
    return test::combine(Shape::Kind::difference,
                         {test::box(std::vector<double>(Dim, 0.0), {size.begin(), size.end()}), hole});
  }
  explicit HoledBlock(MPI_Comm comm = PETSC_COMM_WORLD)
      : coarse(domain(), shape(), {Dim - 1, false}, comm),
        fine(finer(domain()), shape(), {Dim - 1, false}, comm) {}

  test::PartOnGrid<Dim> coarse, fine;
};

/// Far from 0, which stands for what is no part.
template <int Dim>
double linear(const Point<Dim>& x) {
  double result = 100.0;
  for (int axis = 0; axis < Dim; ++axis) result += (0.7 - 0.4 * axis) * x[axis];
  return result;
}

template <int Dim>
std::vector<double> linear_field(const Part<Dim>& part) {
  std::vector<double> result;
  for (const int element : part.elements())
    result.push_back(linear<Dim>(part.grid().element_center(part.grid().owned_elements().index(element))));
  return result;
}

template <class T>
class RefinedFieldTest : public testing::Test {};
TYPED_TEST_SUITE(RefinedFieldTest, test::Dimensions);

/// Also at the edge of the hole, where fine elements of the part lie in coarse ones that are none.
TYPED_TEST(RefinedFieldTest, LinearFieldsStayWhatTheyAre) {
  constexpr int Dim = TypeParam::value;
  const HoledBlock<Dim> block;
  const Part<Dim>&coarse = block.coarse.part, &fine = block.fine.part;
  ASSERT_GT(fine.count(), 0);
  ASSERT_NE(fine.count(), coarse.count() << Dim);
  const std::vector<double> refined = refined_field<Dim>(coarse, linear_field(coarse), fine);
  const std::vector<double> expected = linear_field(fine);
  ASSERT_EQ(refined.size(), expected.size());
  for (std::size_t e = 0; e < expected.size(); ++e) EXPECT_NEAR(refined[e], expected[e], 1e-11);
}

/// Between two centres of the part the values are between theirs, a quarter of the way.
TYPED_TEST(RefinedFieldTest, GoesStraightFromCentreToCentre) {
  constexpr int Dim = TypeParam::value;
  Domain<Dim> domain;
  domain.size.fill(1.0);
  domain.elements.fill(1);
  domain.elements[Dim - 1] = 4;
  const Shape whole = test::box(std::vector<double>(Dim, 0.0), std::vector<double>(Dim, 1.0));
  const test::PartOnGrid<Dim> coarse(domain, whole, {Dim - 1, false}, PETSC_COMM_SELF);
  const test::PartOnGrid<Dim> fine(finer(domain), whole, {Dim - 1, false}, PETSC_COMM_SELF);
  const std::vector<double> values = {1.0, 2.0, 6.0, 7.0},
                            expected = {0.75, 1.25, 1.75, 3.0, 5.0, 6.25, 6.75, 7.25};
  const std::vector<double> refined = refined_field<Dim>(coarse.part, values, fine.part);
  ASSERT_EQ(refined.size(), expected.size() << (Dim - 1));
  for (std::size_t e = 0; e < refined.size(); ++e) EXPECT_NEAR(refined[e], expected[e >> (Dim - 1)], 1e-14);
  const std::vector<double> bounded =
      refined_field<Dim>(coarse.part, values, fine.part, BeyondCentres::value);
  EXPECT_NEAR(bounded.front(), 1.0, 1e-14);
  EXPECT_NEAR(bounded.back(), 7.0, 1e-14);
}

/// Also in fine elements of the part that lie in coarse ones that are none.
TYPED_TEST(RefinedFieldTest, WithoutSlopesNoValueLeavesTheOthers) {
  constexpr int Dim = TypeParam::value;
  const HoledBlock<Dim> block;
  const std::vector<double> noise = test::noise_field(block.coarse.part, 1.0, 2.0);
  for (const double value :
       refined_field<Dim>(block.coarse.part, noise, block.fine.part, BeyondCentres::value)) {
    EXPECT_GE(value, 1.0);
    EXPECT_LE(value, 2.0);
  }
}

TYPED_TEST(RefinedFieldTest, IsTheSameOnAnyNumberOfRanks) {
  constexpr int Dim = TypeParam::value;
  const auto refine = [](const HoledBlock<Dim>& block) {
    const std::vector<double> noise = test::noise_field(block.coarse.part, 1.0, 2.0);
    return test::whole_part_field<Dim>(block.fine.part,
                                       refined_field<Dim>(block.coarse.part, noise, block.fine.part));
  };
  EXPECT_EQ(refine(HoledBlock<Dim>()), refine(HoledBlock<Dim>(PETSC_COMM_SELF)));
}

}  // namespace
}  // namespace fabseq
