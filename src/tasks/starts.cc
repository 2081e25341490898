// SPDX-License-Identifier: MIT
#include "fabseq/tasks/starts.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/session.h"
#include "fabseq/chain/stages.h"
#include "fabseq/files/checkpoint.h"
#include "fabseq/files/output_directory.h"
#include "fabseq/output/records.h"
#include "tasks/carried_design.h"
#include "tasks/write_design.h"

#include <tuple>
#include <utility>

namespace fabseq {

namespace {

/// The settings of a start; what is wrong with them for this part is said of the entry.
template <int Dim>
SequenceSettings settings_of_start(const Setup<Dim>& setup, std::size_t start) {
  SequenceSettings settings = with_start(setup.config, setup.effective().at("sequence"), start);
  settings.kind->fix_lengths(settings, setup.part, setup.config.layers.height_of(setup.layers->count()));
  try {
    (void)settings.kind->places(settings, setup.part);
  } catch (const InputError& error) {
    const std::string message = error.what(), initial = "/sequence/initial";
    if (!message.starts_with(initial)) throw;
    throw InputError(pointer_to("/optimizer/starts", start) + message.substr(initial.size()));
  }
  return settings;
}

template <int Dim>
Design start_design(const Setup<Dim>& setup, std::size_t start) {
  const SequenceSettings settings = settings_of_start(setup, start);
  const auto sequence = make_other_sequence<Dim>(setup, settings, setup.config.solver.finest_tolerance());
  return {setup.groups.share(sequence->initial_design()), setup.layers->variables().start};
}

/// The config of the runs from the starts: the first iterations of the whole.
Config first_iterations(const Config& whole) {
  Config config = whole;
  OptimizerSettings& optimizer = config.optimizer;
  optimizer.starts = Json::array();
  optimizer.later_iterations += optimizer.max_iterations;
  optimizer.max_iterations = optimizer.start_iterations;
  config.output.sensitivity = false;
  complete_derived(config);
  return config;
}

/// How a start stands after its iterations, for summary.json.
Json record_of(const RunOutcome& outcome, const Json& initial) {
  Json record = Json::object({{"initial", initial},
                              {"objective", outcome.objective},
                              {"feasible", outcome.feasible},
                              {"worst_constraint", outcome.worst_constraint},
                              {"merit", outcome.merit}});
  if (outcome.miss) record["violated"] = to_record(*outcome.miss);
  return record;
}

void print_outcome(const RunOutcome& outcome, std::size_t start) {
  const std::string stands = outcome.feasible ? "feasible"
                             : outcome.miss   ? outcome.miss->words
                                              : "not feasible";
  print(formatted("start %zu: merit %.6g, ", start + 1, outcome.merit) + stands);
}

/// Whether a start is better than another. The violation counts where there is one, before the merit.
bool is_better(const RunOutcome& one, const RunOutcome& other) {
  const auto key = [](const RunOutcome& outcome) {
    return std::tuple(!outcome.feasible, outcome.feasible ? 0.0 : outcome.worst_constraint, outcome.merit);
  };
  return key(one) < key(other);
}

/// The best of the starts.
struct Choice {
  std::size_t start;
  std::string directory;  ///< of its run
  RunOutcome outcome;
};

/// Optimizes one after the other. `table`: gets what they come to.
template <int Dim>
Choice choose(const Starts<Dim>& starts, const CommandLine& command_line, const RunPlace& place,
              const Optimize<Dim>& optimize, Json& table) {
  std::optional<Choice> best;
  for (std::size_t k = 0; k < starts.count(); ++k) {
    print(formatted("start %zu of %zu, initial ", k + 1, starts.count()) + starts.name(k) + ": " +
          std::to_string(starts.setup().config.optimizer.max_iterations) + " iterations");
    const RunPlace own = starts.place(place, k);
    const Json initial = parse_json(starts.name(k), "initial");
    PhaseTimer timer;
    try {
      RunOutcome outcome =
          optimize(command_line, starts.setup(), own, starts.design(k, place.directory), timer);
      table.push_back(record_of(outcome, initial));
      print_outcome(outcome, k);
      if (!best || is_better(outcome, best->outcome)) best = {k, own.directory, std::move(outcome)};
    } catch (const NumericalError& error) {
      if (k + 1 == starts.count() && !best) throw;
      warn("start " + std::to_string(k + 1) + " is left out: " + error.what());
      table.push_back(Json::object({{"initial", initial}, {"failure", error.what()}}));
    }
  }
  return std::move(*best);
}

}  // namespace

template <int Dim>
Starts<Dim>::Starts(const Setup<Dim>& setup) : whole_(setup) {
  for (std::size_t k = 0; k < setup.config.optimizer.starts.size(); ++k)
    designs_.push_back(start_design(setup, k));
  config_ = std::make_unique<const Config>(first_iterations(setup.config));
  short_ = std::make_unique<const Setup<Dim>>(setup.world(), *config_);
}

template <int Dim>
RunPlace Starts<Dim>::place(const RunPlace& whole, std::size_t start) const {
  RunPlace result = whole.inside(std::string(starts_folder) + "/" + std::to_string(start + 1));
  // A start that the run has not come to is a new one.
  if (result.restart && !result.restarts_automatically() &&
      find_checkpoint(whole_.world(), *result.restart).empty())
    result.restart = "auto";
  return result;
}

template <int Dim>
FirstDesign Starts<Dim>::design(std::size_t start, const std::string& directory) const {
  const std::string file = directory + "/" + starts_folder + "/start_" + std::to_string(start + 1) + ".h5";
  write_design(whole_, designs_[start], file);
  return {carried_design(whole_, designs_[start], *short_, /*factor=*/1), file};
}

template <int Dim>
FirstDesign Starts<Dim>::result(const Design& design, const std::string& directory) const {
  return {carried_design(*short_, design, whole_, /*factor=*/1), directory + "/result.h5"};
}

template <int Dim>
std::optional<Starts<Dim>> make_starts(const Setup<Dim>& setup, const CommandLine& command_line,
                                       bool on_coarse_grid) {
  const Json& starts = setup.config.optimizer.starts;
  if (starts.empty()) return std::nullopt;
  if (command_line.design_file)
    refuse("/optimizer/starts", shown(starts) + ", but -design names the design to start from", "[]");
  if (!on_coarse_grid) return std::optional<Starts<Dim>>(std::in_place, setup);
  for (std::size_t k = 0; k < starts.size(); ++k) (void)settings_of_start(setup, k);
  return std::nullopt;
}

template <int Dim>
FirstDesign begin_with_starts(const Starts<Dim>& starts, const CommandLine& command_line,
                              const RunPlace& place, RunOutput<Dim>& output, const Optimize<Dim>& optimize) {
  output.directory().make_folder(starts_folder);
  Json table = Json::array();
  std::optional<Choice> best;
  before_the_first<Dim>(output, [&] { best = choose(starts, command_line, place, optimize, table); });
  for (std::size_t k = 0; k < table.size(); ++k) table[k]["chosen"] = k == best->start;
  output.set_starts(table);
  print(formatted("start %zu, initial ", best->start + 1) + starts.name(best->start) + ", goes on");
  return starts.result(best->outcome.design, best->directory);
}

FABSEQ_INSTANTIATE_CLASS(Starts);
FABSEQ_INSTANTIATE_FUNCTION(make_starts);
FABSEQ_INSTANTIATE_FUNCTION(begin_with_starts);

}  // namespace fabseq
