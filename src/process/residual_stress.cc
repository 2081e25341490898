// SPDX-License-Identifier: MIT
#include "fabseq/process/residual_stress.h"

#include "fabseq/base/mpi.h"
#include "process/strained_elements.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace fabseq {

namespace {

/// Calls f(model element, C B u at its centre) for all elements of the model.
template <int Dim, class Function>
void for_each_stress(const ElasticModel<Dim>& model, std::span<const double> displacement, Function&& f) {
  const Grid<Dim>& grid = model.part.grid();
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * Dim);
  grid.exchange(Dim).to_ghosted(displacement, ghosted);
  std::array<double, element_unknowns<Dim>> u{};
  for (std::size_t element = 0; element < model.elements.size(); ++element) {
    for (int i = 0; i < element_unknowns<Dim>; ++i) {
      const std::size_t node = model.domain.first_corners[element] + grid.corner_offsets()[i / Dim];
      u[i] = ghosted[node * Dim + i % Dim];
    }
    f(element, model.element.center_stress(u));
  }
}

template <int Dim>
std::vector<double> zero_stress(const ElasticModel<Dim>& model) {
  return std::vector<double>(
      static_cast<std::size_t>(model.part.grid().owned_elements().count()) * voigt_size<Dim>, 0.0);
}

template <int Dim>
double von_mises(const double* s) {
  if constexpr (Dim == 2) {
    return std::sqrt(s[0] * s[0] - s[0] * s[1] + s[1] * s[1] + 3.0 * s[2] * s[2]);
  } else {
    double square = 0.0;
    for (int a = 0; a < Dim; ++a) {
      const double difference = s[a] - s[(a + 1) % Dim];
      square += 0.5 * difference * difference + 3.0 * s[Dim + a] * s[Dim + a];
    }
    return std::sqrt(square);
  }
}

}  // namespace

template <int Dim>
std::vector<double> residual_stress(const ElasticProcess<Dim>& process, const LayerDensities& densities) {
  constexpr int components = voigt_size<Dim>;
  const ElasticModel<Dim>& model = process.model();
  std::vector<double> stress = zero_stress(model);
  std::vector<int> all_elements(model.part.elements().size());
  std::iota(all_elements.begin(), all_elements.end(), 0);
  const std::vector<BuildStep>& steps = process.systems().steps();
  for (int number = 0; number < static_cast<int>(steps.size()); ++number) {
    const BuildStep& step = steps[number];
    const std::vector<double> increment = process.step_increment(number);
    for_each_stress<Dim>(model, increment, [&](std::size_t element, const auto& elastic) {
      const double stiffness = model.stiffness(model.stage_density(densities.stage[step.layer], element));
      double* at = &stress[static_cast<std::size_t>(model.elements[element]) * components];
      for (int c = 0; c < components; ++c) at[c] += model.material.young * stiffness * elastic[c];
    });
    const StrainedElements strained =
        strained_elements(model, process.strains(), densities, step, number, all_elements);
    for (std::size_t e = 0; e < strained.elements.size(); ++e) {
      const auto inherent = model.element.stress(strained.strain<Dim>(e));
      double* at =
          &stress[static_cast<std::size_t>(model.part.elements()[strained.elements[e]]) * components];
      for (int c = 0; c < components; ++c) at[c] -= model.material.young * strained.factors[e] * inherent[c];
    }
  }
  return stress;
}

template <int Dim>
std::vector<double> finished_stress(const ElasticModel<Dim>& model, std::span<const double> displacement) {
  std::vector<double> stress = zero_stress(model);
  const std::vector<double> stiffness = model.finished_stiffness();
  for_each_stress<Dim>(model, displacement, [&](std::size_t element, const auto& elastic) {
    double* at = &stress[static_cast<std::size_t>(model.elements[element]) * voigt_size<Dim>];
    for (int c = 0; c < voigt_size<Dim>; ++c) at[c] = model.material.young * stiffness[element] * elastic[c];
  });
  return stress;
}

template <int Dim>
std::vector<double> equivalent_stress(const Part<Dim>& part, std::span<const double> stress) {
  std::vector<double> result;
  result.reserve(part.elements().size());
  for (const int element : part.elements())
    result.push_back(von_mises<Dim>(&stress[static_cast<std::size_t>(element) * voigt_size<Dim>]));
  return result;
}

template <int Dim>
StressExtremes<Dim> stress_extremes(const Part<Dim>& part, std::span<const double> stress) {
  constexpr int components = voigt_size<Dim>;
  StressExtremes<Dim> result;
  result.lowest.fill(std::numeric_limits<double>::infinity());
  result.highest.fill(-std::numeric_limits<double>::infinity());
  for (const int element : part.elements()) {
    const double* at = &stress[static_cast<std::size_t>(element) * components];
    result.von_mises = std::max(result.von_mises, von_mises<Dim>(at));
    for (int c = 0; c < components; ++c) {
      result.lowest[c] = std::min(result.lowest[c], at[c]);
      result.highest[c] = std::max(result.highest[c], at[c]);
    }
  }
  const MPI_Comm comm = part.grid().comm();
  result.von_mises = max(comm, result.von_mises);
  for (int c = 0; c < components; ++c) {
    result.lowest[c] = min(comm, result.lowest[c]);
    result.highest[c] = max(comm, result.highest[c]);
  }
  return result;
}

template <int Dim>
double share_beyond(const Part<Dim>& part, std::span<const double> stress, double limit) {
  double beyond = 0.0;
  for (std::size_t e = 0; e < part.elements().size(); ++e)
    if (von_mises<Dim>(&stress[static_cast<std::size_t>(part.elements()[e]) * voigt_size<Dim>]) > limit)
      beyond += part.part_density()[e];
  const Grid<Dim>& grid = part.grid();
  return sum(grid.comm(), beyond) * grid.element_volume() / part.volume();
}

FABSEQ_INSTANTIATE_FUNCTION(residual_stress);
FABSEQ_INSTANTIATE_FUNCTION(finished_stress);
FABSEQ_INSTANTIATE_FUNCTION(equivalent_stress);
FABSEQ_INSTANTIATE_FUNCTION(stress_extremes);
FABSEQ_INSTANTIATE_FUNCTION(share_beyond);

}  // namespace fabseq
