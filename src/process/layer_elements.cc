// SPDX-License-Identifier: MIT
#include "fabseq/process/layer_elements.h"

#include "fabseq/base/log_event.h"
#include "kernels/element_energy.h"

#include <algorithm>
#include <array>

namespace fabseq {

template <int Dim>
LayerElements<Dim>::LayerElements(const ElasticModel<Dim>& model)
    : model_(model), stiffness_(model.element.stiffness()) {}

template <int Dim>
template <class Use>
void LayerElements<Dim>::for_chunks(const BlockRegion& region, const StrainFactors<Dim>& factors,
                                    Use&& use) const {
  const std::size_t elements = model_.part_position.size();
  for (std::size_t begin = 0; begin < elements; begin += chunk_size)
    for_lane_chunks(region.block.lanes, [&]<int Width>(int lane) {
      const Chunk chunk{begin, std::min(begin + chunk_size, elements), region.block.first + lane, region,
                        factors};
      use.template operator()<Width>(chunk, lane);
    });
}

template <int Dim>
std::vector<double> LayerElements<Dim>::stiffness(const LayerDensities& densities,
                                                  const BlockRegion& region) const {
  const int lanes = region.block.lanes;
  // Elements outside the part, where the model has any, keep theirs.
  static const std::vector<double> none;
  std::vector<double> result(model_.elements.size() * lanes);
  for (std::size_t e = 0; e < model_.elements.size(); ++e)
    if (model_.part_element[e] < 0)
      std::fill_n(&result[e * lanes], lanes, model_.stiffness(model_.stage_density(none, e)));
  for_chunks(region, no_change<Dim>(), [&]<int Width>(const Chunk& chunk, int lane) {
    for (int i = 0; i < Width; ++i) {
      const auto& stage = densities.stage[chunk.first_layer + i];
      for (std::size_t e = chunk.begin; e < chunk.end; ++e)
        result[static_cast<std::size_t>(model_.part_position[e]) * lanes + lane + i] =
            counts(chunk, e) ? model_.stiffness(stage[e]) : 0.0;
    }
  });
  return result;
}

template <int Dim>
void LayerElements<Dim>::set_load(const LayerDensities& densities, const BlockRegion& region,
                                  const StrainFactors<Dim>& factors, LaneVector& load) const {
  static const LogEvent event("fabseq loads");
  const auto scope = event.enter();
  const Grid<Dim>& grid = model_.part.grid();
  const int lanes = load.lanes;
  std::vector<double> room;
  std::vector<double>& values = has_all_nodes() ? load.values : room;
  values.assign(static_cast<std::size_t>(grid.ghosted_nodes().count()) * Dim * lanes, 0.0);
  for_chunks(region, factors, [&]<int Width>(const Chunk& chunk, int lane) {
    add_load<Width>(densities, chunk, &values[lane], lanes);
  });
  if (!has_all_nodes()) grid.exchange(Dim * lanes).add_to_owned(room, load.values);
}

template <int Dim>
template <int Width>
void LayerElements<Dim>::add_load(const LayerDensities& densities, const Chunk& chunk, double* load,
                                  int lanes) const {
  std::array<double, chunk_size * Width> factors;
  for (int i = 0; i < Width; ++i) {
    const auto& layer = densities.layer[chunk.first_layer + i];
    for (std::size_t e = chunk.begin; e < chunk.end; ++e)
      factors[(e - chunk.begin) * Width + i] = counts(chunk, e) ? model_.load(layer[e]) : 0.0;
  }
  const auto& corners = model_.part.first_corners();
  const auto& offsets = model_.part.grid().corner_offsets();
  // In full elements, one lane per layer: the same for all elements unless they have strains of their own.
  const auto load_of_material = model_.material_load(chunk.factors);
  std::array<Lanes<Width>, element_unknowns<Dim>> unit_load;
  const auto set_unit_load = [&](std::size_t e) {
    for (int i = 0; i < element_unknowns<Dim>; ++i)
      unit_load[i] = Lanes<Width>::broadcast(strains_.uniform() ? load_of_material[i] : 0.0);
    for (int c = 0; c < voigt_size<Dim> && !strains_.uniform(); ++c) {
      const auto component = strain<Lanes<Width>>(chunk, e, c);
      for (int i = 0; i < element_unknowns<Dim>; ++i) unit_load[i] += component * model_.unit_loads[c][i];
    }
  };
  if (strains_.of_elements.empty()) set_unit_load(chunk.begin);
  for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
    const double* of_element = &factors[(e - chunk.begin) * Width];
    // An element belongs to few layers.
    if (std::all_of(of_element, of_element + Width, [](double factor) { return factor == 0.0; })) continue;
    const auto factor = Lanes<Width>::load(of_element);
    if (!strains_.of_elements.empty()) set_unit_load(e);
    for (int corner = 0; corner < corner_count<Dim>; ++corner)
      for (int a = 0; a < Dim; ++a) {
        double* place = load + (static_cast<std::size_t>(corners[e] + offsets[corner]) * Dim + a) * lanes;
        (Lanes<Width>::load(place) + factor * unit_load[corner * Dim + a]).store(place);
      }
  }
}

template <int Dim>
void LayerElements<Dim>::add_derivatives(const LayerDensities& densities, const BlockRegion& region,
                                         const StrainFactors<Dim>& factors, const LaneVector& increments,
                                         const LaneVector& adjoints, DensityDerivatives& derivatives,
                                         StrainField& d_strains) const {
  static const LogEvent event("fabseq derivatives");
  const auto scope = event.enter();
  const int lanes = increments.lanes;
  for (int layer = region.block.first; layer < region.block.first + lanes; ++layer) {
    DensityDerivatives::touch(derivatives.stage[layer], model_.part_position.size());
    DensityDerivatives::touch(derivatives.layer[layer], model_.part_position.size());
  }
  std::vector<double> u_room, lambda_room;
  const double* u = ghosted(increments, u_room);
  const double* lambda = ghosted(adjoints, lambda_room);
  for_chunks(region, factors, [&]<int Width>(const Chunk& chunk, int lane) {
    add_derivatives<Width>(densities, chunk, u + lane, lambda + lane, lanes, derivatives, d_strains);
  });
}

template <int Dim>
template <int Width>
void LayerElements<Dim>::add_derivatives(const LayerDensities& densities, const Chunk& chunk, const double* u,
                                         const double* lambda, int lanes, DensityDerivatives& derivatives,
                                         StrainField& d_strains) const {
  bool any_counts = false;
  for (std::size_t e = chunk.begin; e < chunk.end && !any_counts; ++e) any_counts = counts(chunk, e);
  if (!any_counts) return;
  std::array<double, chunk_size * Width> mutual, work;
  const ElementEnergy<Dim, Width> energies(stiffness_, model_.material_load(chunk.factors));
  energies.for_each(std::span(model_.part.first_corners()).subspan(chunk.begin, chunk.end - chunk.begin),
                    model_.part.grid().corner_offsets(), u, lambda, lanes,
                    [&](std::size_t e, const auto& energy) {
                      energy.mutual.store(&mutual[e * Width]);
                      energy.work.store(&work[e * Width]);
                    });
  if (!strains_.uniform()) add_strain_derivatives<Width>(densities, chunk, lambda, lanes, work, d_strains);
  for (int i = 0; i < Width; ++i) {
    const int layer = chunk.first_layer + i;
    const double* stage_density = densities.stage[layer].data();
    const double* layer_density = densities.layer[layer].data();
    double* d_stage = derivatives.stage[layer].data();
    double* d_layer = derivatives.layer[layer].data();
    for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
      if (!counts(chunk, e)) continue;
      const std::size_t at = (e - chunk.begin) * Width + i;
      d_stage[e] += model_.stiffness_derivative(stage_density[e]) * mutual[at];
      d_layer[e] -= model_.load_derivative(layer_density[e]) * work[at];
    }
  }
}

template <int Dim>
template <class Result>
Result LayerElements<Dim>::strain(const Chunk& chunk, std::size_t element, int component) const {
  const double of_element =
      chunk.factors[component] * (strains_.of_elements.empty()
                                      ? model_.common_strain[component]
                                      : strains_.of_elements[element * voigt_size<Dim> + component]);
  if (strains_.of_layers.empty()) return Result::broadcast(of_element);
  std::array<double, sizeof(Result) / sizeof(double)> of_layers;
  for (std::size_t i = 0; i < of_layers.size(); ++i)
    of_layers[i] = of_element * strains_.of_layers[(chunk.first_layer + i) * voigt_size<Dim> + component];
  return Result::load(of_layers.data());
}

/// With strain a_c eps_c theta_jc f_c for the unit loads f_c and factors a_c: lambda^T f_0 = sum_c a_c eps_c
/// theta_jc lambda^T f_c, dJ/d(eps_c) = -a_c sum_j theta_jc drho_j^q lambda_j^T f_c, and by the layer's
/// factor dJ/d(theta_jc) = -a_c sum_e eps_c drho_j^q lambda_j^T f_c.
template <int Dim>
template <int Width>
void LayerElements<Dim>::add_strain_derivatives(const LayerDensities& densities, const Chunk& chunk,
                                                const double* lambda, int lanes, std::span<double> work,
                                                StrainField& d_strains) const {
  constexpr int components = voigt_size<Dim>;
  const auto& corners = model_.part.first_corners();
  const auto& offsets = model_.part.grid().corner_offsets();
  for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
    std::array<double, Width> factors{};
    bool has_load = false;
    for (int i = 0; counts(chunk, e) && i < Width; ++i) {
      const double density = densities.layer[chunk.first_layer + i][e];
      factors[i] = model_.load(density);
      has_load = has_load || factors[i] != 0.0 || model_.load_derivative(density) != 0.0;
    }
    double* of_element = &work[(e - chunk.begin) * Width];
    std::fill_n(of_element, Width, 0.0);
    if (!has_load) continue;  // an element belongs to few layers
    std::array<Lanes<Width>, components> duals;
    duals.fill(Lanes<Width>::zero());
    for (int i = 0; i < element_unknowns<Dim>; ++i) {
      const std::size_t unknown = static_cast<std::size_t>(corners[e] + offsets[i / Dim]) * Dim + i % Dim;
      const auto value = Lanes<Width>::load(lambda + unknown * lanes);
      for (int c = 0; c < components; ++c) duals[c] += value * model_.unit_loads[c][i];
    }
    auto sum = Lanes<Width>::zero();
    for (int c = 0; c < components; ++c) {
      sum += duals[c] * strain<Lanes<Width>>(chunk, e, c);
      std::array<double, Width> dual{};
      (duals[c] * chunk.factors[c]).store(dual.data());
      for (int i = 0; i < Width; ++i) {
        const std::size_t of_layer = static_cast<std::size_t>(chunk.first_layer + i) * components + c;
        if (!d_strains.of_elements.empty())
          d_strains.of_elements[e * components + c] -=
              factors[i] * dual[i] * (strains_.of_layers.empty() ? 1.0 : strains_.of_layers[of_layer]);
        if (!d_strains.of_layers.empty())
          d_strains.of_layers[of_layer] -=
              factors[i] * dual[i] *
              (strains_.of_elements.empty() ? model_.common_strain[c]
                                            : strains_.of_elements[e * components + c]);
      }
    }
    sum.store(of_element);
  }
}

template <int Dim>
const double* LayerElements<Dim>::ghosted(const LaneVector& owned, std::vector<double>& room) const {
  if (has_all_nodes()) return owned.values.data();
  const Grid<Dim>& grid = model_.part.grid();
  const int components = Dim * owned.lanes;
  room.resize(static_cast<std::size_t>(grid.ghosted_nodes().count()) * components);
  grid.exchange(components).to_ghosted(owned.values, room);
  return room.data();
}

FABSEQ_INSTANTIATE_CLASS(LayerElements);

}  // namespace fabseq
