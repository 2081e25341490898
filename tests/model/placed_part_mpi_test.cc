// SPDX-License-Identifier: MIT
/// The characteristic length that "auto" stands for (formulation 2.1).
#include "support/pipeline_case.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

using test::operator+;

/// Layers and a heat sequence whose length the config leaves open, with a target thickness of 0.5.
const Settings automatic = {{"sequence", R"({"type": "heat"})"}, {"layers", R"({"count": 4})"}};

template <int Dim>
Setup<Dim> setup_of(const Config& config) {
  return Setup<Dim>(PETSC_COMM_WORLD, config);
}

/// Of the gallows with some keys set.
template <int Dim>
double length_with(const Settings& settings) {
  const Config config = test::gallows_config<Dim>(automatic + settings);
  return setup_of<Dim>(config).characteristic_length;
}

template <class T>
class CharacteristicLengthTest : public testing::Test {};
TYPED_TEST_SUITE(CharacteristicLengthTest, test::Dimensions);

TYPED_TEST(CharacteristicLengthTest, IsTheLayersTimesTheirTarget) {
  constexpr int dim = TypeParam::value;
  EXPECT_DOUBLE_EQ(length_with<dim>({}), 4 * 0.5);
  EXPECT_DOUBLE_EQ(length_with<dim>({{"constraints.layer_thickness.target", "0.3"}}), 4 * 0.3);
  EXPECT_DOUBLE_EQ(length_with<dim>({{"sequence.characteristic_length", "7"}}), 7.0);
  const Config config = test::gallows_config<dim>(automatic + Settings{{"layers.count", "auto"}});
  const auto setup = setup_of<dim>(config);
  EXPECT_GT(setup.layers->count(), 4);
  EXPECT_DOUBLE_EQ(setup.characteristic_length, setup.layers->count() * 0.5);
}

TYPED_TEST(CharacteristicLengthTest, IsTheLongestEdgeElsewhere) {
  constexpr int dim = TypeParam::value;
  const double longest_edge = dim == 2 ? 3.0 : 2.5;
  EXPECT_DOUBLE_EQ(length_with<dim>({{"constraints", "[]"}}), longest_edge);
  for (const char* sequence : {R"({"type": "direct", "location": "nodes"})", R"({"type": "planar"})"})
    EXPECT_DOUBLE_EQ(length_with<dim>({{"sequence", sequence}}), longest_edge) << sequence;
}

/// The config that a run leaves keeps the pseudo-time of its design, whatever layers it is cut into.
TYPED_TEST(CharacteristicLengthTest, StaysInTheEffectiveConfig) {
  constexpr int dim = TypeParam::value;
  const Config config = test::gallows_config<dim>(automatic);
  Json effective = setup_of<dim>(config).effective();
  EXPECT_EQ(effective["sequence"]["characteristic_length"], 2.0);
  EXPECT_EQ(config.effective.at("sequence").at("characteristic_length"), "auto");
  effective["layers"]["count"] = 7;
  const Config recut = make_config(effective, "/base");
  EXPECT_EQ(setup_of<dim>(recut).characteristic_length, 2.0);
  EXPECT_EQ(setup_of<dim>(recut).effective(), effective);
}

}  // namespace
}  // namespace fabseq
