// SPDX-License-Identifier: MIT
#include "fabseq/keys/section.h"
#include "fabseq/process/process_settings.h"

#include <cmath>

namespace fabseq {

namespace {

void read_strain(MaterialSettings& material, const Json& value, const KeyPlace&) {
  if (value.is_object())
    material.turning_strain =
        TurningStrain{value.at("tangential").get<double>(), value.at("normal").get<double>()};
  else
    material.inherent_strain = value.get<std::vector<double>>();
}

}  // namespace

std::vector<double> voigt_factors(const std::vector<double>& of_axes) {
  std::vector<double> result = of_axes;
  const std::size_t dimension = of_axes.size();
  for (std::size_t a = 0; a < dimension * (dimension - 1) / 2; ++a)  // xy, yz, zx; in 2D xy
    result.push_back(std::sqrt(of_axes[a] * of_axes[(a + 1) % dimension]));
  return result;
}

Section<MaterialSettings> material_keys() {
  using Its = MaterialSettings;
  return Section<Its>("material", "Material; displacements do not depend on Young's modulus")
      .key("file", "JSON file with any of these keys, which keys beside it replace",
           {.type = KeyType::path, .option = "-material"}, [](Its&, const Json&, const KeyPlace&) {})
      .key("name", &Its::name, "A label")
      .key("young", &Its::young, "Young's modulus",
           {.range = "(0, inf)", .unit = "stress", .option = "-young"})
      .key("poisson", &Its::poisson, "Poisson's ratio", {.range = "(-1, 0.5)", .option = "-poisson"})
      .key("mass_density", &Its::mass_density, "Density, for the mass of wire",
           {.range = "(0, inf)", .words = "none", .unit = "kg/length^3"})
      .key("yield_stress", &Its::yield_stress, "Yield stress, to compare the residual stress with",
           {.range = "(0, inf)", .words = "none", .unit = "stress", .option = "-yield_stress"})
      .key("hardening", &Its::hardening, "Stress per plastic strain, isotropic",
           {.range = "[0, inf)", .unit = "stress"})
      .key("temperatures", &Its::temperatures,
           "Ascending temperatures of the lists of factors and elongations; linear between, constant beyond",
           {.type = KeyType::list, .default_value = "[]", .unit = "degrees C"})
      .key("young_factors", &Its::young_factors, "Factors on young at these temperatures; empty: 1",
           {.type = KeyType::list, .default_value = "[]", .range = "(0, inf)"})
      .key("yield_factors", &Its::yield_factors,
           "Factors on yield_stress and hardening at these temperatures; empty: 1",
           {.type = KeyType::list, .default_value = "[]", .range = "(0, inf)"})
      .key("elongations", &Its::elongations, "Free thermal strain at these temperatures",
           {.type = KeyType::list, .default_value = "[]"})
      .key("cut_off", &Its::cut_off, "Temperature above which there is no thermal strain",
           {.range = "(-273.15, inf)", .words = "none", .unit = "degrees C"})
      .key("conductivity", &Its::conductivity, "Thermal conductivity",
           {.range = "(0, inf)", .words = "none", .unit = "W/(length*K)"})
      .key("heat_capacity", &Its::heat_capacity, "Specific heat capacity",
           {.range = "(0, inf)", .words = "none", .unit = "J/(kg*K)"})
      .key("conductivity_factors", &Its::conductivity_factors,
           "Factors on the material's own conductivity at these temperatures; empty: 1",
           {.type = KeyType::list, .default_value = "[]", .range = "(0, inf)"})
      .key("heat_capacity_factors", &Its::heat_capacity_factors, "Factors on its heat_capacity; empty: 1",
           {.type = KeyType::list, .default_value = "[]", .range = "(0, inf)"})
      .key("solidification", &Its::solidification, "Temperature at which it solidifies",
           {.range = "(-273.15, inf)", .words = "none", .unit = "degrees C"})
      .key("inherent_strain",
           "Inherent strain: a Voigt vector, or values along and across the layers, with which it turns",
           {.type = KeyType::strain,
            .default_value = "[-0.01, -0.01, -0.01, 0, 0, 0]",
            .default_2d = "[-0.01, -0.01, 0]"},
           read_strain)
      .key("strain_scale", &Its::strain_scale,
           "Factors on the inherent strain per axis; shear by the root of its two",
           {.default_value = "[1, 1, 1]", .default_2d = "[1, 1]", .range = "[0, inf)"})
      .key("scenarios", &Its::scenarios,
           "Possible strains: for each, factors per axis, on top of strain_scale",
           {.type = KeyType::vectors, .default_value = "[]", .range = "[0, inf)"})
      .then([](Its& material, const Json&, const KeyPlace&) {
        const std::vector<double> factors = voigt_factors(material.strain_scale);
        for (std::size_t c = 0; c < material.inherent_strain.size(); ++c)
          material.inherent_strain[c] *= factors[c];
      });
}

Section<ProcessSettings> process_keys() {
  using Its = ProcessSettings;
  return Section<Its>("process", "Process simulation")
      .key("model", &Its::model,
           "Material: linear elastic, or with plastic flow beyond material.yield_stress (3D)",
           {.words = "linear elastoplastic"})
      .key("stiffness_penalty", &Its::stiffness_penalty, "Exponent p of the density in the stiffness",
           {.range = "[1, inf)"})
      .key("strain_penalty", &Its::strain_penalty,
           "Exponent q of the layer's density in the load, not below p", {.range = "[1, inf)"})
      .key("min_stiffness", &Its::min_stiffness, "Stiffness of unbuilt material, relative to the material's",
           {.range = "(0, 1)"})
      .key("void", &Its::void_model,
           "Elements outside the part are left out (absent) or have min_stiffness (quiet)",
           {.words = "absent quiet", .option = "-void"})
      .key("deposition", &Its::deposition,
           "A place moves from the layer on that builds it (nominal), or from the first layer (follow)",
           {.words = "nominal follow", .option = "-deposition"})
      .key("deposition_rate", &Its::deposition_rate, "Wire deposited per hour of welding",
           {.range = "(0, inf)", .words = "none", .unit = "kg/h", .option = "-deposition_rate"})
      .key("dwell", &Its::dwell, "Pause after each real layer (layers.passes)",
           {.range = "[0, inf)", .unit = "s"});
}

}  // namespace fabseq
