// SPDX-License-Identifier: MIT
/// \file
/// Values, gradients and fields of a config's problem, as lists of numbers.
#pragma once

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"
#include "fabseq/config/setup.h"
#include "fabseq/config/unlikely_numbers.h"
#include "fabseq/grid/box_gather.h"
#include "fabseq/keys/config_key.h"
#include "fabseq/optimize/problem.h"
#include "fabseq/report/sequence_report.h"
#include "fabseq/tasks/starting_design.h"
#include "python/design_entries.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

using NamedGradients = std::vector<std::pair<std::string, std::vector<double>>>;

/// A field on the whole grid, with the axes that it has in result.h5.
struct WholeField {
  std::string name;
  std::vector<std::int64_t> shape;
  std::vector<double> values;
};

/// What a config asks for, in two or three dimensions. Designs and gradients are this rank's share of their
/// entries: of the sequence's field, and on the first rank the variables of the layers after it.
class Evaluation {
 public:
  virtual ~Evaluation() = default;
  virtual const DesignEntries& entries() const = 0;
  /// Bounds and scale of each entry.
  virtual std::vector<DesignScale> scales() = 0;
  virtual std::vector<double> start() const = 0;
  /// `beta`: sharpness of the layers; none: that of a run's first iteration.
  virtual std::vector<NamedValue> evaluate(std::span<const double> design, std::optional<double> beta) = 0;
  /// Returns the gradients of these components, or of all without names, at the last evaluated design.
  virtual NamedGradients gradients(const std::vector<std::string>& names) = 0;
  /// Returns the fields of the last evaluated design.
  virtual std::vector<WholeField> fields() = 0;
};

template <int Dim>
class EvaluationIn : public Evaluation {
 public:
  explicit EvaluationIn(Config config) : config_(std::move(config)), setup_(PETSC_COMM_WORLD, config_) {
    for (const std::string& line : unlikely_numbers(config_, PartFigures(setup_))) warn(line);
    setup_.require_walls();
    setup_.require_memory_of_layers();
    const double tolerance = std::min(config_.solver.finest_tolerance(), 1e-9);  // of -task evaluate
    pipeline_.emplace(setup_, tolerance, timer_);
    pipeline_->set_region(setup_.config.solver.region_of_evaluations());
    problem_.emplace(setup_, config_.optimizer.constraint_margin);
    design_ = starting_design(setup_, pipeline_->sequence(), CommandLine());
    start_ = to_entries(design_);
    entries_.emplace(setup_.world(), numbers());
  }

  const DesignEntries& entries() const override { return *entries_; }
  std::vector<double> start() const override { return start_; }

  std::vector<DesignScale> scales() override {
    const DesignSpace space = setup_.space_of_share(pipeline_->sequence());
    std::vector<DesignScale> result;
    for (std::size_t i = 0; i < field_size(); ++i) result.push_back(space.of(i));
    const LayerVariables& variables = setup_.layers->variables();
    for (std::size_t i = 0; i < layer_variables(); ++i)
      result.push_back({variables.lower[i], variables.upper[i]});
    return result;
  }

  std::vector<NamedValue> evaluate(std::span<const double> design, std::optional<double> beta) override {
    entries_->require("design", design, entries_->share());
    const double sharpness = beta.value_or(setup_.layers->traits().first_beta);
    run_on_all(setup_.world(), [&] {
      if (!(sharpness >= 1e-40 && sharpness <= 1e40))
        refuse("beta", shown(sharpness), "a number > 0, from 1e-40 to 1e40");
    });
    state_.reset();
    take(design);
    state_.emplace(pipeline_->run(design_, sharpness, setup_.binary()));
    values_ = pipeline_->values(problem_->responses(), *state_);
    return problem_->describe(values_);
  }

  NamedGradients gradients(const std::vector<std::string>& names) override {
    require_state();
    NamedGradients result;
    std::vector<GradientRow> rows;
    for (const GradientRow& row : all_components(values_)) {
      const std::string name = problem_->component_name(row[0].response, row[0].component);
      if (!names.empty() && std::find(names.begin(), names.end(), name) == names.end()) continue;
      rows.push_back(row);
      result.emplace_back(name, std::vector<double>());
    }
    for (const std::string& name : names)
      if (std::none_of(result.begin(), result.end(), [&](const auto& entry) { return entry.first == name; }))
        throw InputError("gradients: found " + shown(name) + "; allowed: names of the values");
    const std::vector<Design> found = pipeline_->gradients(problem_->responses(), *state_, rows);
    for (std::size_t i = 0; i < found.size(); ++i) result[i].second = to_entries(found[i]);
    return result;
  }

  std::vector<WholeField> fields() override {
    require_state();
    const SequenceReport report =
        report_sequence(setup_, *problem_, *pipeline_, *state_, /*with_shape=*/false);
    const std::vector<double> design = setup_.design_field(design_.field);
    FieldSet<Dim> fields{&setup_.grid, {}};
    fields.add_elements("density", setup_.part.density());
    fields.add(setup_.design_support.on_nodes(), "design", design, setup_.design_support.components());
    add_sequence_fields(fields, setup_.part, report, "");
    std::vector<WholeField> result;
    for (const auto& field : fields.fields) result.push_back(whole(field));
    return result;
  }

 private:
  std::size_t field_size() const { return design_.field.size(); }
  /// Entries of this rank that are variables of the layers.
  std::size_t layer_variables() const {
    return rank_of(setup_.world()) == 0 ? setup_.layers->variables().count() : 0;
  }

  std::vector<std::int64_t> numbers() {
    const DesignSupport<Dim>& support = setup_.design_support;
    const std::size_t first = setup_.groups.first_of_share(pipeline_->sequence().variables());
    std::vector<std::int64_t> result;
    for (std::size_t i = 0; i < field_size(); ++i) result.push_back(support.number(first + i));
    const std::int64_t beyond = setup_.grid.all_nodes().count() * support.components();
    for (std::size_t i = 0; i < layer_variables(); ++i)
      result.push_back(beyond + static_cast<std::int64_t>(i));
    return result;
  }

  void take(std::span<const double> entries) {
    const std::span<const double> field = entries.first(field_size()), rest = entries.subspan(field_size());
    std::copy(field.begin(), field.end(), design_.field.begin());
    std::copy(rest.begin(), rest.end(), design_.layer_variables.begin());
    broadcast(setup_.world(), design_.layer_variables);
  }
  std::vector<double> to_entries(const Design& design) const {
    std::vector<double> result = design.field;
    const auto begin = design.layer_variables.begin();
    result.insert(result.end(), begin, begin + static_cast<std::ptrdiff_t>(layer_variables()));
    return result;
  }

  void require_state() const {
    if (!state_) throw InputError("gradients, fields: found no evaluated design; allowed: after evaluate()");
  }

  WholeField whole(const typename FieldSet<Dim>::Field& field) const {
    const Grid<Dim>& grid = setup_.grid;
    const IndexBox<Dim>& owned = field.on_nodes ? grid.owned_nodes() : grid.owned_elements();
    const IndexBox<Dim> all = field.on_nodes ? grid.all_nodes() : grid.all_elements();
    const auto components = static_cast<std::size_t>(field.components);
    std::vector<double> room;
    const std::span<const double> own = field.whole(owned.count(), room);
    WholeField result{field.name, {}, std::vector<double>(all.count() * components)};
    const BoxGather<Dim> gather(grid.comm(), owned, all);
    for (std::size_t c = 0; c < components; ++c) {
      const auto values = gather.template gather<double>(
          [&](const Index<Dim>& index) { return own[owned.offset(index) * components + c]; });
      for (std::size_t i = 0; i < values.size(); ++i) result.values[i * components + c] = values[i];
    }
    for (int axis = Dim - 1; axis >= 0; --axis) result.shape.push_back(all.size[axis]);
    if (components > 1) result.shape.push_back(field.components);
    return result;
  }

  Config config_;
  PhaseTimer timer_;
  Setup<Dim> setup_;
  std::optional<Pipeline<Dim>> pipeline_;
  std::optional<Problem<Dim>> problem_;
  Design design_;  ///< the last evaluated one, at first the start
  std::vector<double> start_;
  std::optional<DesignEntries> entries_;
  std::optional<StageResults<Dim>> state_;  ///< of the last evaluated design
  std::vector<std::vector<double>> values_;
};

/// Throws InputError for what is wrong with the model.
inline std::unique_ptr<Evaluation> make_evaluation(Config config) {
  if (config.dimension() == 2) return std::make_unique<EvaluationIn<2>>(std::move(config));
  return std::make_unique<EvaluationIn<3>>(std::move(config));
}

}  // namespace fabseq
