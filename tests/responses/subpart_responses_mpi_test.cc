// SPDX-License-Identifier: MIT
/// Responses of sub-parts against sums over the gathered fields, their derivatives against differences
/// (formulation 7).
#include "fabseq/base/mpi.h"
#include "support/response.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace fabseq {
namespace {

constexpr int subparts = 3;

/// Random times and gradients, and directions that need not be of unit length.
template <int Dim>
struct Case {
  Case() {
    time.time = test::noise_field(part(), 0.0, 1.0);
    for (int a = 0; a < Dim; ++a) {
      const auto component = test::noise_field(part(), -1.0, 1.0, 3 + a);
      time.gradient.resize(component.size() * Dim);
      for (std::size_t e = 0; e < component.size(); ++e) time.gradient[e * Dim + a] = component[e];
    }
    SubParts& sub_parts = layers.sub_parts;
    sub_parts.timestamps = {0.35, 0.7};
    for (int d = 0; d < subparts * Dim; ++d) sub_parts.directions.push_back(test::noise(d, 20) - 0.5);
    for (int i = 0; i < subparts; ++i)
      sub_parts.density.push_back(test::noise_field(part(), 0.0, 1.0, 30 + i));
  }
  const Part<Dim>& part() const { return on_grid.part; }
  ResponseContext<Dim> context() const { return {part(), node_sets, 1.0, {}, subparts}; }
  StageResults<Dim> state() const { return {time, layers, process}; }

  test::PartOnGrid<Dim> on_grid{test::odd_domain<Dim>(), test::gallows<Dim>()};
  std::map<std::string, NodeSet> node_sets;
  PseudoTime<Dim> time;
  LayerDensities layers;
  ProcessResult process{};
};

template <int Dim>
auto subpart_volume(const Case<Dim>& c) {
  return test::make_response<Dim>(TermList::constraints, R"({"type": "subpart_volume", "tolerance": 0.02})",
                                  c.context());
}
template <int Dim>
auto segmentation_alignment(const Case<Dim>& c, double band) {
  const std::string term = R"({"type": "segmentation_alignment", "band": )" + to_text(band) + "}";
  return test::make_response<Dim>(TermList::objective, term, c.context());
}

template <class T>
class SubpartResponsesTest : public testing::Test {};
TYPED_TEST_SUITE(SubpartResponsesTest, test::Dimensions);

TYPED_TEST(SubpartResponsesTest, VolumeIsThatOverAnEqualShare) {
  Case<TypeParam::value> c;
  const auto response = subpart_volume(c);
  EXPECT_FALSE(response->uses_displacements());
  const auto values = response->values(c.state());
  ASSERT_EQ(values.size(), 3u);
  for (int i = 0; i < subparts; ++i) {
    double mean = 0.0;
    for (const double density : c.layers.sub_parts.density[i]) mean += density;
    mean = sum(PETSC_COMM_WORLD, mean) / static_cast<double>(c.part().count());
    EXPECT_NEAR(values[i], subparts * mean - 1.0, 1e-12);
    StageDerivatives<TypeParam::value> adjoint(4);
    response->add_derivative(i, 0.7, c.state(), adjoint);
    for (int k = 0; k < subparts; ++k)
      for (const double derivative : adjoint.densities.sub_part[k])
        EXPECT_NEAR(derivative, k == i ? 0.7 * subparts / static_cast<double>(c.part().count()) : 0.0, 1e-15);
  }
  const auto rows = response->rows(0.5);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(rows[0].violation(0.03), 0.02, 1e-15);
}

/// The baseline has no sub-parts.
TYPED_TEST(SubpartResponsesTest, AreUndefinedWithoutSubParts) {
  Case<TypeParam::value> c;
  c.layers.sub_parts = {};
  const auto volumes = subpart_volume(c)->values(c.state());
  EXPECT_EQ(volumes.size(), 3u);
  EXPECT_TRUE(std::isnan(volumes[2]));
  EXPECT_TRUE(std::isnan(segmentation_alignment(c, 0.1)->values(c.state())[0]));
}

template <int Dim>
double expected_alignment(const Case<Dim>& c, double band) {
  const double k = 100.0;
  const auto step = [&](double t, double s) {
    return 1.0 - (std::tanh(k * s) + std::tanh(k * (t - s))) / (std::tanh(k * s) + std::tanh(k * (1.0 - s)));
  };
  double total = 0.0;
  for (std::size_t e = 0; e < c.time.time.size(); ++e)
    for (int i = 1; i < subparts; ++i) {
      const double tau = c.layers.sub_parts.timestamps[i - 1];
      double square = 1e-9, product = 0.0;
      for (int a = 0; a < Dim; ++a) {
        const double of_temperature = -c.time.gradient[e * Dim + a];
        square += of_temperature * of_temperature;
        product += of_temperature * c.layers.sub_parts.directions[i * Dim + a];
      }
      total += (step(c.time.time[e], tau + band) - step(c.time.time[e], tau)) *
               (product / std::sqrt(square) + 1.0);
    }
  return sum(PETSC_COMM_WORLD, total);
}

TYPED_TEST(SubpartResponsesTest, AlignmentFollowsTheFormula) {
  const Case<TypeParam::value> c;
  for (const double band : {0.1, 0.25}) {
    const auto response = segmentation_alignment(c, band);
    EXPECT_NEAR(response->values(c.state())[0], expected_alignment(c, band), 1e-11);
  }
}

TYPED_TEST(SubpartResponsesTest, AlignmentDerivativeAgreesWithDifferences) {
  constexpr int Dim = TypeParam::value;
  Case<Dim> c;
  const auto response = segmentation_alignment(c, 0.2);
  StageDerivatives<Dim> adjoint(4);
  response->add_derivative(0, 0.7, c.state(), adjoint);
  const auto check = [&](std::vector<double>& values, const std::vector<double>& derivative,
                         bool distributed) {
    const std::vector<double> start = values;
    std::vector<double> along;
    for (std::size_t i = 0; i < values.size(); ++i)
      along.push_back(test::noise(static_cast<std::int64_t>(i), 40) - 0.5);
    const double expected = test::central_difference(
        [&](double step) {
          values = test::moved(start, step, along);
          return 0.7 * response->values(c.state())[0];
        },
        2e-5);
    values = start;
    // Of directions every rank has all, and a part of the derivative.
    EXPECT_EQ(derivative.size(), values.size()) << distributed;
    EXPECT_NEAR(test::dot(derivative, along), expected, 1e-6 * std::abs(expected));
  };
  check(c.time.time, adjoint.time.time, true);
  check(c.time.gradient, adjoint.time.gradient, true);
  check(c.layers.sub_parts.directions, adjoint.densities.directions, false);
}

}  // namespace
}  // namespace fabseq
