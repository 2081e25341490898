// SPDX-License-Identifier: MIT
/// Numbers that cannot be meant have one line each; what is usual has none.
#include "fabseq/config/unlikely_numbers.h"

#include "support/small_configs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace fabseq {
namespace {

/// Of a steel part.
Settings steel(const Settings& changes) {
  Settings result = {{"domain.unit", "mm"},
                     {"material.mass_density", "7.85e-6"},
                     {"material.young", "210000"},
                     {"material.yield_stress", "400"},
                     {"process.deposition_rate", "2"},
                     {"process.dwell", "60"},
                     {"thermal", R"({"conductivity": 0.04, "heat_capacity": 600, "vanishing": 1450,
                                     "heat_input": 5e6, "film_coefficient": 2e-5})"}};
  result.insert(result.end(), changes.begin(), changes.end());
  return result;
}

/// The part is 100 mm long, its elements 2 mm.
std::vector<std::string> lines(const Settings& changes, double millimetre = 1.0) {
  return unlikely_numbers(
      configure(solid, steel(changes)),
      PartFigures(1e5 * std::pow(millimetre, 3), 100.0 * millimetre, 2.0 * millimetre, 20));
}

/// The key that the only line begins with.
std::string key_of(const Settings& changes) {
  const std::vector<std::string> found = lines(changes);
  if (found.size() != 1) return std::to_string(found.size()) + " lines";
  EXPECT_NE(found[0].find(": found "), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("; expected: "), std::string::npos) << found[0];
  return found[0].substr(0, found[0].find(':'));
}

TEST(UnlikelyNumbers, OfAnOrdinaryPartThereAreNone) {
  const std::vector<std::string> none;
  EXPECT_EQ(lines({}), none);
  EXPECT_EQ(lines({{"domain.unit", "pixels"}}), none);
  EXPECT_EQ(lines({{"domain.unit", "metres"},
                   {"material.mass_density", "7850"},
                   {"thermal.conductivity", "40"},
                   {"thermal.film_coefficient", "20"},
                   {"constraints.0.target", "0.004"}},
                  1e-3),
            none);
  EXPECT_EQ(unlikely_numbers(configure(plane), PartFigures(2.0, 2.0, 0.25, 4)), none);
}

TEST(UnlikelyNumbers, Strains) {
  EXPECT_EQ(key_of({{"material.inherent_strain", "[-1, -1, -1, 0, 0, 0]"}}), "/material/inherent_strain");
  EXPECT_EQ(key_of({{"material.inherent_strain", "[0, 0, 0, 0, 0, 0.2]"}}), "/material/inherent_strain");
  EXPECT_EQ(key_of({{"material.inherent_strain", R"({"tangential": 0, "normal": -0.5})"}}),
            "/material/inherent_strain");
  EXPECT_EQ(key_of({{"material.strain_scale", "[1, 1, 80]"}}), "/material/inherent_strain");
  EXPECT_EQ(key_of({{"material.inherent_strain", R"({"tangential": 0.01, "normal": 0})"},
                    {"material.strain_scale", "[1, 1, 80]"}}),
            "/material/inherent_strain");
  EXPECT_EQ(key_of({{"material.scenarios", "[[1, 1, 1], [1, 115, 1]]"}}), "/material/scenarios");
  EXPECT_EQ(key_of({{"material.inherent_strain", "[-0.1, 0, 0, 0, 0, 0]"}}), "0 lines");
}

TEST(UnlikelyNumbers, Temperatures) {
  for (const char* key : {"ambient", "plate", "reference"}) {
    EXPECT_EQ(key_of({{std::string("thermal.") + key, "293.15"}}), std::string("/thermal/") + key);
    EXPECT_EQ(key_of({{std::string("thermal.") + key, "150"}}), "0 lines");
  }
  EXPECT_EQ(key_of({{"thermal.vanishing", "1.5e6"}}), "/thermal/vanishing");
  EXPECT_EQ(key_of({{"thermal.interpass_limit", "1500"}}), "/thermal/interpass_limit");
}

TEST(UnlikelyNumbers, HeatOfTheArc) {
  EXPECT_EQ(key_of({{"thermal.heat_input", "2500"}}), "/thermal/heat_input");  // W
  EXPECT_EQ(key_of({{"thermal.heat_input", "8.5e5"}}), "/thermal/heat_input");
  EXPECT_EQ(key_of({{"thermal.heat_input", "8.7e5"}}), "0 lines");
  EXPECT_EQ(key_of({{"thermal.heat_input", "5e9"}}), "/thermal/heat_input");
}

TEST(UnlikelyNumbers, WhatTheUnitOfLengthTells) {
  EXPECT_EQ(key_of({{"thermal.conductivity", "40"}}), "/thermal/conductivity");
  EXPECT_EQ(key_of({{"thermal.conductivity", "material"}, {"material.conductivity", "40"}}),
            "/material/conductivity");
  EXPECT_EQ(key_of({{"material.mass_density", "7.85e-9"}}), "/material/mass_density");
  EXPECT_EQ(key_of({{"material.mass_density", "7850"}}), "/material/mass_density");
  EXPECT_EQ(key_of({{"domain.unit", "in"}}), "/material/mass_density");  // the conductivity might be
  EXPECT_EQ(lines({{"domain.unit", "m"}}).size(), 2U);
}

TEST(UnlikelyNumbers, WithoutAUnitTheFourierNumberTells) {
  const std::vector<std::string> found = lines({{"domain.unit", "pixels"}, {"thermal.conductivity", "40"}});
  ASSERT_EQ(found.size(), 1U);
  // k dt / (rho c h^2), dt a quarter of 70.65 s with the torch on, or of 60 s.
  EXPECT_EQ(
      found[0].rfind("/thermal/conductivity: found 40, a Fourier number of 3.75e+04 in a step of 17.7 s", 0),
      0U)
      << found[0];
}

TEST(UnlikelyNumbers, OtherUnits) {
  EXPECT_EQ(key_of({{"thermal.heat_capacity", "0.6"}}), "/thermal/heat_capacity");
  EXPECT_EQ(key_of({{"thermal.film_coefficient", "20"}}), "/thermal/film_coefficient");
  for (const std::string key : {"conductivity_factors", "heat_capacity_factors"})
    EXPECT_EQ(key_of({{"material.temperatures", "[20, 700]"}, {"material." + key, "[440, 1000]"}}),
              "/material/" + key);
  EXPECT_EQ(key_of({{"material.yield_stress", "4e8"}}), "/material/yield_stress");
  EXPECT_EQ(key_of({{"material.young", "2.1e11"}}), "/material/yield_stress");
  EXPECT_EQ(key_of({{"process.dwell", "120000"}}), "/process/dwell");
  EXPECT_EQ(key_of({{"process.deposition_rate", "5e-4"}}), "/process/deposition_rate");
  EXPECT_EQ(key_of({{"process.deposition_rate", "2000"}}), "/process/deposition_rate");
}

TEST(UnlikelyNumbers, LengthsAndAngles) {
  EXPECT_EQ(key_of({{"tool.bead_width", "0.006"}}), "/tool/bead_width");
  EXPECT_EQ(key_of({{"tool.bead_width", "6000"}}), "/tool/bead_width");
  EXPECT_EQ(key_of({{"tool.bead_width", "6"}}), "0 lines");
  EXPECT_EQ(key_of({{"constraints.0.target", "300"}}), "/constraints/0/target");
  EXPECT_EQ(key_of({{"tool.profile", "[[0.015, 0.004], [0.3, 0.02]]"}}), "/tool/profile");
  EXPECT_EQ(key_of({{"tool.profile", "[[15, 4], [300, 20]]"}}), "0 lines");
  EXPECT_EQ(key_of({{"tool.max_tilt", "0.785"}}), "/tool/max_tilt");
  EXPECT_EQ(key_of({{"layers", R"({"type": "multi_planar", "subparts": 2, "angle_bounds": [0, 90]})"},
                    {"objective", "[]"},
                    {"constraints", "[]"}}),
            "/layers/angles");
}

}  // namespace
}  // namespace fabseq
