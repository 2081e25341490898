// SPDX-License-Identifier: MIT
/// A result counted as the other deposition model does is that of a simulation which has that model
/// (formulation 4.6), and afterwards it is as before.
#include "fabseq/process/counted_as.h"
#include "support/process_case.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace fabseq {
namespace {

template <class T>
class CountedAsTest : public testing::Test {};
TYPED_TEST_SUITE(CountedAsTest, test::Dimensions);

constexpr int layers = 10;  // more than a block

template <int Dim>
struct Simulated {
  Simulated(test::CaseSettings<Dim> settings, DepositionModel model)
      : process((settings.process.deposition = model, settings)),
        densities(process.densities(process.wavy_time(), layers, 25.0)) {
    (void)process.simulate(densities);
  }
  ProcessResult& result() { return process.simulation.result(); }
  /// On all nodes.
  std::vector<double> displacement() { return process.whole(result().displacement); }
  std::vector<double> increments() const {
    std::vector<double> result;
    for (int j = 0; j < layers; ++j)
      for (const double value : process.whole(process.simulation.layer_increment(j, true)))
        result.push_back(value);
    return result;
  }

  test::ProcessCase<Dim> process;
  LayerDensities densities;
};

TYPED_TEST(CountedAsTest, IsTheOtherModelForAsLongAsItLives) {
  constexpr int Dim = TypeParam::value;
  auto cases = test::void_models<Dim>();
  cases.push_back(test::clamped_cases<Dim>().front());
  constexpr auto follow = DepositionModel::follow, nominal = DepositionModel::nominal;
  for (const auto& settings : cases) {
    for (const auto& [own, other] : {std::pair{follow, nominal}, std::pair{nominal, follow}}) {
      Simulated<Dim> simulated(settings, own), expected(settings, other);
      const auto displacement = simulated.displacement(), increments = simulated.increments();
      {
        const CountedAs<Dim> counted(other, simulated.process.model, simulated.process.groups,
                                     simulated.densities, simulated.result());
        EXPECT_LT(test::relative_difference(simulated.displacement(), expected.displacement()), 1e-7);
        EXPECT_LT(test::relative_difference(simulated.increments(), expected.increments()), 1e-7);
        EXPECT_GT(test::relative_difference(simulated.displacement(), displacement), 1e-2);
      }
      EXPECT_EQ(simulated.displacement(), displacement);
      EXPECT_EQ(simulated.increments(), increments);
    }
  }
}

}  // namespace
}  // namespace fabseq
