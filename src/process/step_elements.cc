// SPDX-License-Identifier: MIT
#include "fabseq/process/step_elements.h"

#include "fabseq/base/log_event.h"
#include "kernels/element_energy.h"
#include "process/load_factors.h"

#include <algorithm>
#include <array>

namespace fabseq {

namespace {

/// Sets `load` to that of a strain, [Voigt][lane], in a full element.
template <int Dim, int Width>
void set_unit_load(const ElasticModel<Dim>& model, const double* strain,
                   std::array<Lanes<Width>, element_unknowns<Dim>>& load) {
  load.fill(Lanes<Width>::zero());
  for (int c = 0; c < voigt_size<Dim>; ++c) {
    const auto component = Lanes<Width>::load(strain + c * Width);
    for (int i = 0; i < element_unknowns<Dim>; ++i) load[i] += component * model.unit_loads[c][i];
  }
}

}  // namespace

template <int Dim>
StepElements<Dim>::StepElements(const ElasticModel<Dim>& model)
    : model_(model), stiffness_(model.element.stiffness()) {}

template <int Dim>
StepElements<Dim>::Strains::Strains(const ElasticModel<Dim>& model, const StrainSource<Dim>& source_)
    : source(source_), variation(source.variation()) {
  if (variation != StrainVariation::none) return;
  std::array<double, voigt_size<Dim>> strain;
  const int any = 0;
  source.set_strains({&any, 1}, {0, 1}, strain);
  common_load = model.element.strain_load(strain);
}

template <int Dim>
template <class Use>
void StepElements<Dim>::for_chunks(const BlockRegion& region, Use&& use) const {
  const std::size_t elements = model_.part_position.size();
  for (std::size_t begin = 0; begin < elements; begin += chunk_size)
    for_lane_chunks(region.block.lanes, [&]<int Width>(int lane) {
      const Chunk chunk{begin, std::min(begin + chunk_size, elements), lane, region};
      use.template operator()<Width>(chunk, lane);
    });
}

template <int Dim>
std::vector<double> StepElements<Dim>::stiffness(const LayerDensities& densities,
                                                 const BlockRegion& region) const {
  const int lanes = region.block.lanes;
  // Elements outside the part, where the model has any, keep theirs.
  static const std::vector<double> none;
  std::vector<double> result(model_.elements.size() * lanes);
  for (std::size_t e = 0; e < model_.elements.size(); ++e)
    if (model_.part_element[e] < 0)
      std::fill_n(&result[e * lanes], lanes, model_.stiffness(model_.stage_density(none, e)));
  for_chunks(region, [&]<int Width>(const Chunk& chunk, int lane) {
    for (int i = 0; i < Width; ++i) {
      const auto& stage = densities.stage[chunk.step(i).layer];
      for (std::size_t e = chunk.begin; e < chunk.end; ++e)
        result[static_cast<std::size_t>(model_.part_position[e]) * lanes + lane + i] =
            counts(chunk, e) ? model_.stiffness(stage[e]) : 0.0;
    }
  });
  return result;
}

template <int Dim>
LaneVector StepElements<Dim>::at_nodes(std::span<const double> of_elements, int lanes) const {
  const Grid<Dim>& grid = model_.part.grid();
  std::vector<double> of_nodes(static_cast<std::size_t>(grid.ghosted_nodes().count()) * lanes, 0.0);
  for (std::size_t e = 0; e < model_.elements.size(); ++e)
    for (const int offset : grid.corner_offsets()) {
      const std::size_t node = model_.domain.first_corners[e] + offset;
      for (int lane = 0; lane < lanes; ++lane) of_nodes[node * lanes + lane] += of_elements[e * lanes + lane];
    }
  LaneVector result(static_cast<int>(grid.owned_nodes().count()), 1, lanes);
  grid.exchange(lanes).add_to_owned(of_nodes, result.values);
  return result;
}

template <int Dim>
void StepElements<Dim>::set_load(const LayerDensities& densities, const BlockRegion& region,
                                 const StrainSource<Dim>& strains, LaneVector& load) const {
  static const LogEvent event("fabseq loads");
  const auto scope = event.enter();
  const Grid<Dim>& grid = model_.part.grid();
  const Strains of_block(model_, strains);
  const int lanes = load.lanes;
  std::vector<double> room;
  std::vector<double>& values = has_all_nodes() ? load.values : room;
  values.assign(static_cast<std::size_t>(grid.ghosted_nodes().count()) * Dim * lanes, 0.0);
  for_chunks(region, [&]<int Width>(const Chunk& chunk, int lane) {
    add_load<Width>(densities, of_block, chunk, &values[lane], lanes);
  });
  if (!has_all_nodes()) grid.exchange(Dim * lanes).add_to_owned(room, load.values);
}

template <int Dim>
template <int Width, class Use>
void StepElements<Dim>::for_batches(const Strains& strains, const Chunk& chunk, std::span<const int> elements,
                                    Use&& use) {
  constexpr std::size_t size = voigt_size<Dim> * Width;
  const StepBlock steps = chunk.steps(Width);
  std::array<double, batch_size * size> values;
  const bool own = strains.variation == StrainVariation::by_element;
  for (std::size_t first = 0; first < elements.size(); first += batch_size) {
    const auto batch = elements.subspan(first, std::min(batch_size, elements.size() - first));
    if (own)
      strains.source.set_strains(batch, steps, std::span(values).first(batch.size() * size));
    else if (first == 0)
      strains.source.set_strains(batch.first(1), steps, std::span(values).first(size));
    use(batch, values.data(), own ? size : 0);
  }
}

template <int Dim>
template <int Width>
void StepElements<Dim>::add_load(const LayerDensities& densities, const Strains& strains, const Chunk& chunk,
                                 double* load, int lanes) const {
  std::array<double, chunk_size * Width> factors;
  for (int i = 0; i < Width; ++i) {
    const LoadFactors<Dim> of_step(model_, densities, chunk.step(i));
    for (std::size_t e = chunk.begin; e < chunk.end; ++e)
      factors[(e - chunk.begin) * Width + i] = counts(chunk, e) ? of_step(e) : 0.0;
  }
  std::array<int, chunk_size> room;  // an element is loaded in few steps
  std::size_t count = 0;
  for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
    const double* of_element = &factors[(e - chunk.begin) * Width];
    if (std::any_of(of_element, of_element + Width, [](double factor) { return factor != 0.0; }))
      room[count++] = static_cast<int>(e);
  }
  const auto loaded = std::span<const int>(room).first(count);
  const auto& corners = model_.part.first_corners();
  const auto& offsets = model_.part.grid().corner_offsets();
  std::array<Lanes<Width>, element_unknowns<Dim>> unit_load;  // in full elements, one lane per step
  const auto add = [&](int e) {
    const auto factor = Lanes<Width>::load(&factors[(e - chunk.begin) * Width]);
    for (int corner = 0; corner < corner_count<Dim>; ++corner)
      for (int a = 0; a < Dim; ++a) {
        double* place = load + (static_cast<std::size_t>(corners[e] + offsets[corner]) * Dim + a) * lanes;
        (Lanes<Width>::load(place) + factor * unit_load[corner * Dim + a]).store(place);
      }
  };
  if (strains.variation == StrainVariation::none) {
    for (int i = 0; i < element_unknowns<Dim>; ++i)
      unit_load[i] = Lanes<Width>::broadcast(strains.common_load[i]);
    for (const int e : loaded) add(e);
    return;
  }
  bool is_set = false;
  const auto add_own = [&](std::span<const int> elements, const double* strain, std::size_t stride) {
    for (std::size_t k = 0; k < elements.size(); ++k) {
      if (stride != 0 || !is_set) set_unit_load<Dim, Width>(model_, strain + k * stride, unit_load);
      is_set = true;
      add(elements[k]);
    }
  };
  for_batches<Width>(strains, chunk, loaded, add_own);
}

template <int Dim>
void StepElements<Dim>::add_derivatives(const LayerDensities& densities, const BlockRegion& region,
                                        const StrainSource<Dim>& strains, const LaneVector& increments,
                                        const LaneVector& adjoints, DensityDerivatives& derivatives,
                                        std::span<double> d_inputs) const {
  static const LogEvent event("fabseq derivatives");
  const auto scope = event.enter();
  const Strains of_block(model_, strains);
  const int lanes = increments.lanes;
  for (const BuildStep& step : region.steps) {
    DensityDerivatives::zeros_if_empty(derivatives.stage[step.layer], model_.part_position.size());
    DensityDerivatives::zeros_if_empty(derivatives.layer[step.layer], model_.part_position.size());
  }
  std::vector<double> u_room, lambda_room;
  const double* u = ghosted(increments, u_room);
  const double* lambda = ghosted(adjoints, lambda_room);
  for_chunks(region, [&]<int Width>(const Chunk& chunk, int lane) {
    add_derivatives<Width>(densities, of_block, chunk, u + lane, lambda + lane, lanes, derivatives, d_inputs);
  });
}

template <int Dim>
template <int Width>
void StepElements<Dim>::add_derivatives(const LayerDensities& densities, const Strains& strains,
                                        const Chunk& chunk, const double* u, const double* lambda, int lanes,
                                        DensityDerivatives& derivatives, std::span<double> d_inputs) const {
  bool any_counts = false;
  for (std::size_t e = chunk.begin; e < chunk.end && !any_counts; ++e) any_counts = counts(chunk, e);
  if (!any_counts) return;
  std::array<double, chunk_size * Width> mutual, work;
  const ElementEnergy<Dim, Width> energies(stiffness_, strains.common_load);
  energies.for_each(std::span(model_.part.first_corners()).subspan(chunk.begin, chunk.end - chunk.begin),
                    model_.part.grid().corner_offsets(), u, lambda, lanes,
                    [&](std::size_t e, const auto& energy) {
                      energy.mutual.store(&mutual[e * Width]);
                      energy.work.store(&work[e * Width]);
                    });
  if (strains.variation != StrainVariation::none || !d_inputs.empty())
    add_strain_derivatives<Width>(densities, strains, chunk, lambda, lanes, work, d_inputs);
  for (int i = 0; i < Width; ++i) {
    const BuildStep& step = chunk.step(i);
    const double* stage_density = densities.stage[step.layer].data();
    double* d_stage = derivatives.stage[step.layer].data();
    const LoadFactors<Dim> load_factors(model_, densities, step);
    double* d_loaded = step.adds ? derivatives.layer[step.layer].data() : d_stage;
    for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
      if (!counts(chunk, e)) continue;
      const std::size_t at = (e - chunk.begin) * Width + i;
      d_stage[e] += model_.stiffness_derivative(stage_density[e]) * mutual[at];
      d_loaded[e] -= load_factors.derivative(e) * work[at];
    }
  }
}

/// Adds derivatives with respect to strains eps_jc of unit loads f_c: lambda_j^T f_0 = sum_c eps_jc
/// lambda_j^T f_c, and dJ/d(eps_jc) = -drho_j^q lambda_j^T f_c.
template <int Dim>
template <int Width>
void StepElements<Dim>::add_strain_derivatives(const LayerDensities& densities, const Strains& strains,
                                               const Chunk& chunk, const double* lambda, int lanes,
                                               std::span<double> work, std::span<double> d_inputs) const {
  constexpr int components = voigt_size<Dim>;
  const auto& corners = model_.part.first_corners();
  const auto& offsets = model_.part.grid().corner_offsets();
  std::array<int, chunk_size> room;  // an element is loaded in few steps
  std::array<double, chunk_size * Width> factors;
  std::size_t count = 0;
  std::vector<LoadFactors<Dim>> of_steps;
  for (int i = 0; i < Width; ++i) of_steps.emplace_back(model_, densities, chunk.step(i));
  for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
    bool has_load = false;
    double* of_element = &factors[(e - chunk.begin) * Width];
    for (int i = 0; counts(chunk, e) && i < Width; ++i) {
      of_element[i] = of_steps[i](e);
      has_load = has_load || of_element[i] != 0.0 || of_steps[i].derivative(e) != 0.0;
    }
    if (has_load)
      room[count++] = static_cast<int>(e);
    else
      std::fill_n(&work[(e - chunk.begin) * Width], Width, 0.0);
  }
  const auto add = [&](std::span<const int> elements, const double* strain, std::size_t stride) {
    std::array<double, batch_size * components * Width> d_strains;
    for (std::size_t k = 0; k < elements.size(); ++k) {
      const int e = elements[k];
      std::array<Lanes<Width>, components> duals;
      duals.fill(Lanes<Width>::zero());
      for (int i = 0; i < element_unknowns<Dim>; ++i) {
        const std::size_t unknown = static_cast<std::size_t>(corners[e] + offsets[i / Dim]) * Dim + i % Dim;
        const auto value = Lanes<Width>::load(lambda + unknown * lanes);
        for (int c = 0; c < components; ++c) duals[c] += value * model_.unit_loads[c][i];
      }
      const auto factor = Lanes<Width>::load(&factors[(e - chunk.begin) * Width]);
      auto sum = Lanes<Width>::zero();
      for (int c = 0; c < components; ++c) {
        sum += duals[c] * Lanes<Width>::load(strain + k * stride + c * Width);
        (Lanes<Width>::zero() - factor * duals[c]).store(&d_strains[(k * components + c) * Width]);
      }
      sum.store(&work[(e - chunk.begin) * Width]);
    }
    if (!d_inputs.empty())
      strains.source.add_derivatives(elements, chunk.steps(Width),
                                     std::span(d_strains).first(elements.size() * components * Width),
                                     d_inputs);
  };
  for_batches<Width>(strains, chunk, std::span<const int>(room).first(count), add);
}

template <int Dim>
const double* StepElements<Dim>::ghosted(const LaneVector& owned, std::vector<double>& room) const {
  if (has_all_nodes()) return owned.values.data();
  const Grid<Dim>& grid = model_.part.grid();
  const int components = Dim * owned.lanes;
  room.resize(static_cast<std::size_t>(grid.ghosted_nodes().count()) * components);
  grid.exchange(components).to_ghosted(owned.values, room);
  return room.data();
}

FABSEQ_INSTANTIATE_CLASS(StepElements);

}  // namespace fabseq
