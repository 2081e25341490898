// SPDX-License-Identifier: MIT
/// Continuity against a double loop over the gathered pseudo-time, its derivative against differences
/// (formulation 7).
#include "support/response.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace fabseq {
namespace {

template <int Dim>
class ContinuityCase {
 public:
  explicit ContinuityCase(std::vector<char> start)
      : start_(std::move(start)),
        response_(test::make_response<Dim>(TermList::constraints, R"({"type": "continuity", "limit": 2e-3})",
                                           {part(), node_sets_, 1.0, start_})),
        time_{test::noise_field(part(), 0.0, 1.0), {}, {}, {}},
        layers_(),
        process_() {}

  static bool starts(std::int64_t number) { return number % 3 == 0; }
  const Part<Dim>& part() const { return on_grid_.part; }
  const Response<Dim>& response() const { return *response_; }
  std::vector<double>& time() { return time_.time; }
  StageResults<Dim> state() const { return {time_, layers_, process_}; }
  double value() const { return response_->values(state())[0]; }

  /// By definition, on the whole grid; elements in the start region do not count.
  double expected() const {
    const Grid<Dim>& grid = part().grid();
    const auto inside = test::whole_part_field(part(), std::vector<double>(time_.time.size(), 1.0));
    const auto time = test::whole_part_field(part(), time_.time);
    double total = 0.0, count = 0.0;
    grid.all_elements().for_each([&](const Index<Dim>& element, std::int64_t number) {
      if (inside[number] == 0.0 || (!start_.empty() && starts(number))) return;
      count += 1.0;
      double sum = 0.0, neighbours = 0.0;
      for (int axis = 0; axis < Dim; ++axis)
        for (const int step : {-1, 1}) {
          Index<Dim> other = element;
          other[axis] += step;
          if (!grid.all_elements().contains(other)) continue;
          const std::int64_t place = grid.all_elements().offset(other);
          sum += inside[place] * time[place];
          neighbours += inside[place];
        }
      total += std::pow(time[number] - sum / neighbours, 2);
    });
    return total / count;
  }

 private:
  test::PartOnGrid<Dim> on_grid_{test::odd_domain<Dim>(), test::gallows<Dim>()};
  std::map<std::string, NodeSet> node_sets_;
  std::vector<char> start_;
  std::unique_ptr<Response<Dim>> response_;
  PseudoTime<Dim> time_;
  LayerDensities layers_;
  ProcessResult process_;
};

/// Every third element of the part, by its number in the grid.
template <int Dim>
std::vector<char> every_third() {
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  std::vector<char> result;
  for (const double starts : test::part_field(
           on_grid.part, [](std::int64_t number) { return ContinuityCase<Dim>::starts(number) ? 1.0 : 0.0; }))
    result.push_back(starts > 0.0 ? 1 : 0);
  return result;
}

template <class T>
class ContinuityTest : public testing::Test {};
TYPED_TEST_SUITE(ContinuityTest, test::Dimensions);

TYPED_TEST(ContinuityTest, IsTheMeanSquareOfTheDifferences) {
  constexpr int Dim = TypeParam::value;
  for (const auto& start : {std::vector<char>{}, every_third<Dim>()}) {
    const ContinuityCase<Dim> continuity(start);
    EXPECT_NEAR(continuity.value(), continuity.expected(), 1e-13);
    EXPECT_FALSE(continuity.response().uses_displacements());
  }
}

TYPED_TEST(ContinuityTest, DerivativeAgreesWithDifferences) {
  constexpr int Dim = TypeParam::value;
  for (const auto& start : {std::vector<char>{}, every_third<Dim>()}) {
    ContinuityCase<Dim> continuity(start);
    const auto direction = test::noise_field(continuity.part(), -1.0, 1.0, 4);
    StageDerivatives<Dim> adjoint(3);
    adjoint.time.time.assign(direction.size(), 0.0);
    continuity.response().add_derivative(0, 0.7, continuity.state(), adjoint);
    const std::vector<double> time = continuity.time();
    const double expected = test::central_difference(
        [&](double step) {
          continuity.time() = test::moved(time, step, direction);
          return 0.7 * continuity.value();
        },
        1e-2);
    EXPECT_NEAR(test::dot(adjoint.time.time, direction), expected, 1e-11);
  }
}

/// The optimizer gets it relative to the limit, with a margin.
TYPED_TEST(ContinuityTest, RowIsRelativeToTheLimit) {
  const ContinuityCase<TypeParam::value> continuity({});
  const auto rows = continuity.response().rows(0.9);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(rows[0].violation(2e-3), 0.1, 1e-14);
  EXPECT_NEAR(continuity.response().rows(1.0)[0].violation(3e-3), 0.5, 1e-14);
}

}  // namespace
}  // namespace fabseq
