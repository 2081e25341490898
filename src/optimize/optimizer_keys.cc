// SPDX-License-Identifier: MIT
#include "fabseq/base/formatted.h"
#include "fabseq/keys/section.h"
#include "fabseq/model/model_settings.h"
#include "fabseq/optimize/optimizer_settings.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/sequence/sequence_kind.h"

#include <algorithm>

namespace fabseq {

namespace {

Section<MmaSettings> asymptote_keys() {
  using Its = MmaSettings;
  return Section<Its>("optimizer.asymptotes", "Asymptotes")
      .key("initial", &Its::asymptote_initial, "First distance over the variable's range",
           {.range = "(0, 10]"})
      .key("increase", &Its::asymptote_increase, "Factor while a variable keeps its direction",
           {.range = "[1, inf)"})
      .key("decrease", &Its::asymptote_decrease, "Factor when a variable turns", {.range = "(0, 1]"})
      .key("floor", &Its::asymptote_floor, "Least distance over the variable's range", {.range = "(0, 10]"});
}

/// Adds the keys for when and how a run ends.
void add_ends(Section<OptimizerSettings>& keys) {
  using Its = OptimizerSettings;
  keys.key("max_iterations", &Its::max_iterations, "Iterations at most",
           {.range = "[1, inf)", .option = "-max_iterations"})
      .key("change_tolerance", &Its::change_tolerance,
           "Ends when no variable moves by this share of its range in `window` iterations at the last "
           "sharpness; 0: never",
           {.range = "[0, inf)", .option = "-change_tolerance"})
      .key("objective_tolerance", &Its::objective_tolerance,
           "Ends when the feasible objective varies by less, over its scale, in `window` iterations at the "
           "last sharpness; 0: never",
           {.range = "[0, inf)", .option = "-objective_tolerance"})
      .key("window", &Its::window, "Iterations of the two tolerances",
           {.range = "[1, 10000]", .unit = "iterations", .option = "-window"});
}

void add_steps(Section<OptimizerSettings>& keys) {
  using Its = OptimizerSettings;
  const auto of_kinds = [](std::string SequenceTraits::*trait) {
    return join(of_sequence_kinds(trait), ", ");
  };
  const std::string first = of_kinds(&SequenceTraits::move_limits),
                    last = of_kinds(&SequenceTraits::last_move_limits);
  keys.key("move_limit", &Its::given_move_limit,
           ("Largest step of a variable over its range; auto: " + first).c_str(),
           {.range = "(0, 1]", .words = "auto", .option = "-move_limit"})
      .key("final_move_limit", &Its::given_final_move_limit,
           ("Largest step at the end; auto: " + formatted("%g", MoveLimits().last_with_squares) +
            " where a distortion may be squares, but for tilts; else " + last + ", else move_limit")
               .c_str(),
           {.range = "(0, 1]", .words = "auto", .option = "-final_move_limit"})
      .section("asymptotes", &Its::mma, "Asymptotes", asymptote_keys(), {.default_value = "{}"})
      .key("constraint_margin", &Its::constraint_margin,
           "Share of the constraints' tolerance for the optimizer",
           {.range = "(0, 1]", .option = "-constraint_margin"});
}

void add_phases(Section<OptimizerSettings>& keys) {
  using Its = OptimizerSettings;
  keys.key("binary_iterations", &Its::binary_iterations,
           "The last iterates that are judged by their binary layers, too, a simulation each",
           {.range = "[0, inf)", .option = "-binary_iterations"})
      .key("repair_iterations", &Its::repair_iterations,
           "More iterations, at most, while the best iterate still fails exact checks of the machine's "
           "limits, and then a repair of its layers; needs binary_iterations",
           {.range = "[0, inf)"})
      .key("repair_share", &Its::repair_share,
           "Largest share of the part's elements that this repair, or -repair, moves to other layers",
           {.range = "[0, 0.1]"})
      .key("coarse_iterations", &Its::coarse_iterations,
           "Iterations at half the resolution before the others",
           {.range = "[0, inf)", .option = "-coarse_iterations"})
      .key("coarse_grids", &Its::coarse_grids,
           "Grids that share the coarse iterations: 2 begins at a quarter of the resolution",
           {.range = "[1, 4]", .option = "-coarse_grids"})
      .key(
          "starts",
          "Designs to begin with, like sequence.initial: the best after start_iterations on the coarsest "
          "grid goes on",
          {.type = KeyType::starts, .default_value = "[]"},
          [](Its& optimizer, const Json& value, const KeyPlace&) { optimizer.starts = value; },
          [](Its& optimizer, Json& object) { object["starts"] = optimizer.starts; })
      .key("start_iterations", &Its::start_iterations, "Iterations of each of the starts",
           {.range = "[1, inf)"})
      .key("earlier_iterations", &Its::earlier_iterations, "Iterations by which the schedules are ahead",
           {.range = "[0, inf)"})
      .key("later_iterations", &Its::later_iterations,
           "Iterations of a later run, for which the move limit is planned", {.range = "[0, inf)"});
}

/// Whether the optimizer may get a term of the objective as a sum of squares: Problem, which knows the part,
/// decides in each iteration.
bool may_be_squares(const std::vector<Term>& objective) {
  const auto counts = [](const Term& term) { return term.weight != 0.0; };
  const auto largest = [&](const Term& term) { return counts(term) && term.type->facts(term).is_largest; };
  if (std::any_of(objective.begin(), objective.end(), largest)) return false;
  return std::any_of(objective.begin(), objective.end(), [&](const Term& term) {
    const TermFacts facts = term.type->facts(term);
    return counts(term) &&
           (facts.asks_for_squares || (facts.offers_squares && term.scaling == TermScaling::current));
  });
}

}  // namespace

Section<OptimizerSettings> optimizer_keys() {
  Section<OptimizerSettings> keys("optimizer", "Optimizer (method of moving asymptotes)");
  add_ends(keys);
  add_steps(keys);
  add_phases(keys);
  return keys;
}

void complete_move_limits(OptimizerSettings& optimizer, const SequenceSettings& sequence,
                          const std::vector<Term>& objective) {
  const MoveLimits& automatic = sequence.facts.move_limits;
  optimizer.move_limit = optimizer.given_move_limit.value_or(automatic.first);
  const double last =
      may_be_squares(objective) ? automatic.last_with_squares : automatic.last.value_or(optimizer.move_limit);
  optimizer.final_move_limit =
      optimizer.given_final_move_limit.value_or(std::min(last, optimizer.move_limit));
}

namespace {

void read_direction(BaselineSettings& settings, const Json& value, const KeyPlace&) {
  settings.best_direction = value == "best";
  if (value.is_array()) settings.direction = value.get<std::vector<double>>();
}

/// Derived problems do without the search.
void write_direction(BaselineSettings& settings, Json& object) {
  if (!settings.best_direction && object.at("direction") == "best") object["direction"] = "auto";
}

}  // namespace

Section<BaselineSettings> baseline_keys() {
  using Its = BaselineSettings;
  return Section<Its>("baseline", "Sequences the result is compared with")
      .key("layers", &Its::layers,
           "Number of planar layers; auto: height over target thickness, else layers.count",
           {.range = "[1, 10000]", .words = "auto", .option = "-baseline_layers"})
      .key("direction",
           "Build direction of the planar layers; auto: the plate's normal; best: also the best of several "
           "within tool.max_tilt",
           {.type = KeyType::vector, .default_value = to_text("auto"), .words = "auto best"}, read_direction,
           write_direction)
      .key("even", &Its::even, "Also layers of equal thickness along the part");
}

}  // namespace fabseq
