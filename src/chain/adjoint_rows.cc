// SPDX-License-Identifier: MIT
#include "fabseq/chain/adjoint_rows.h"

#include "fabseq/parallel/step_dealing.h"
#include "fabseq/solve/heat_solver.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

template <int Dim>
std::vector<AdjointRow<Dim>*> rows_with(std::deque<AdjointRow<Dim>>& rows, bool AdjointRow<Dim>::*property) {
  std::vector<AdjointRow<Dim>*> result;
  for (AdjointRow<Dim>& row : rows)
    if (row.*property) result.push_back(&row);
  return result;
}

}  // namespace

std::vector<GradientRow> all_components(const std::vector<std::vector<double>>& values) {
  std::vector<GradientRow> rows;
  for (std::size_t r = 0; r < values.size(); ++r)
    for (std::size_t c = 0; c < values[r].size(); ++c)
      rows.push_back({{static_cast<int>(r), static_cast<int>(c), 1.0}});
  return rows;
}

template <int Dim>
AdjointRows<Dim>::AdjointRows(const Model<Dim>& model, PhaseTimer& timer, Responses<Dim> responses,
                              const StageResults<Dim>& state, const Layers& layers,
                              const std::vector<GradientRow>& rows, std::size_t variables)
    : model_(model), timer_(timer), responses_(responses), state_(state) {
  for (const GradientRow& terms : rows) {
    AdjointRow<Dim>& row = rows_.emplace_back(terms, layers, state, variables);
    row.shared = std::any_of(terms.begin(), terms.end(), [&](const WeightedComponent& term) {
      return responses[term.response]->uses_displacements();
    });
  }
  const std::vector<double> work(rows.size(), 1.0);  // one adjoint of the sequence per row
  const StepDeal deal = deal_out_steps(work, model.groups.count(), widest_block, model.block_solver());
  for (int group = 0; group < model.groups.count(); ++group)
    for (const StepBlock& block : deal.blocks[group])
      for (int row = block.first; row < block.first + block.lanes; ++row) {
        rows_[row].owner = group;
        rows_[row].own = group == model.groups.index();
      }
}

template <int Dim>
std::vector<AdjointRow<Dim>*> AdjointRows<Dim>::shared() {
  return rows_with(rows_, &AdjointRow<Dim>::shared);
}

template <int Dim>
std::vector<AdjointRow<Dim>*> AdjointRows<Dim>::own() {
  return rows_with(rows_, &AdjointRow<Dim>::own);
}

/// Other groups than the owner keep what leads to the process alone.
template <int Dim>
void AdjointRows<Dim>::add_explicit(AdjointRow<Dim>& row) const {
  {
    const auto scope = timer_.enter(Phase::responses);
    for (const WeightedComponent& term : row.terms)
      if (row.own || responses_[term.response]->uses_displacements())
        responses_[term.response]->add_derivative(term.component, term.weight, state_, row.adjoint);
  }
  const auto scope = timer_.enter(Phase::layers);
  if (!row.own) row.adjoint.for_each([](auto& derivatives) { derivatives.drop(); });
  if (rank_of(model_.groups.domain()) != 0)
    row.adjoint.for_each([](auto& derivatives) { derivatives.keep_once(); });
  row.sink.flush();
}

template <int Dim>
void AdjointRows<Dim>::sum_at_owners() {
  for (AdjointRow<Dim>& row : rows_)
    if (row.shared)
      row.adjoint.for_each([&](auto& derivatives) { derivatives.sum_at(model_.groups, row.owner); });
}

template <int Dim>
std::vector<Design> AdjointRows<Dim>::gradients(std::size_t variables) {
  std::vector<std::vector<double>> own;
  std::vector<int> owners;
  for (AdjointRow<Dim>& row : rows_) {
    owners.push_back(row.owner);
    if (row.own) own.push_back(std::move(row.field));
  }
  auto fields = model_.groups.share_out(own, owners, variables);
  auto layer_variables = summed_layer_variables();
  std::vector<Design> result;
  for (std::size_t row = 0; row < rows_.size(); ++row)
    result.push_back({std::move(fields[row]), std::move(layer_variables[row])});
  return result;
}

template <int Dim>
std::vector<std::vector<double>> AdjointRows<Dim>::summed_layer_variables() const {
  std::vector<std::vector<double>> result;
  std::vector<double> sums;
  for (const AdjointRow<Dim>& row : rows_) {
    result.push_back(row.layer_variables);
    sums.insert(sums.end(), row.layer_variables.begin(), row.layer_variables.end());
  }
  if (sums.empty()) return result;
  sum_in_place(model_.world(), sums);
  auto next = sums.begin();
  for (std::vector<double>& row : result)
    for (double& value : row) value = *next++;
  return result;
}

template <int Dim>
std::vector<int> AdjointRows<Dim>::iterations() const {
  std::vector<int> result;
  for (const AdjointRow<Dim>& row : rows_) result.push_back(row.iterations);
  model_.groups.sum(result);
  return result;
}

FABSEQ_INSTANTIATE_CLASS(AdjointRows);

}  // namespace fabseq
