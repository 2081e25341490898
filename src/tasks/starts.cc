// SPDX-License-Identifier: MIT
#include "fabseq/tasks/starts.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/session.h"
#include "fabseq/chain/stages.h"
#include "fabseq/files/checkpoint.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/files/output_directory.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace fabseq {

namespace {

std::string folder_of_start(const std::string& directory, std::size_t start) {
  return directory + "/" + starts_folder + "/" + std::to_string(start + 1);
}

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
std::vector<double> start_design(const Setup<Dim>& setup, std::size_t start) {
  const SequenceSettings settings = settings_of_start(setup, start);
  const auto sequence = make_other_sequence<Dim>(setup, settings, setup.config.solver.finest_tolerance());
  return setup.design_support.expand(sequence->initial_design());
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

/// How a start stands after its iterations, for summary.json. Collective.
Json outcome(MPI_Comm comm, const std::string& folder, const Json& initial) {
  const std::string file = folder + "/summary.json";
  const Json summary = parse_json(broadcast(comm, rank_of(comm) == 0 ? read_file_if_there(file) : ""), file);
  Json objective = Json::array();
  for (const Json& response : summary.at("optimized").at("responses"))
    if (response.at("name").get<std::string>().starts_with("objective"))
      objective.push_back(response.at("value"));
  Json record = Json::object({{"initial", initial}, {"objective", objective}});
  for (const char* key : {"feasible", "worst_constraint", "merit"}) record[key] = summary.at(key);
  if (const auto miss = summary.find("violated"); miss != summary.end()) record["violated"] = *miss;
  return record;
}

void print_outcome(const Json& record, std::size_t start) {
  const auto miss = record.find("violated");
  const std::string stands = record.at("feasible").get<bool>() ? "feasible"
                             : miss != record.end()            ? miss->at("words").get<std::string>()
                                                               : "not feasible";
  print(formatted("start %zu: merit %.6g, ", start + 1, record.at("merit").get<double>()) + stands);
}

/// Whether a start is better than another. The violation counts where there is one, before the merit.
bool is_better(const Json& one, const Json& other) {
  const auto key = [](const Json& record) {
    const bool feasible = record.at("feasible").get<bool>();
    return std::tuple(!feasible, feasible ? 0.0 : record.at("worst_constraint").get<double>(),
                      record.at("merit").get<double>());
  };
  return key(one) < key(other);
}

/// Optimizes one after the other; the number of the best. `table`: gets what they come to.
template <int Dim>
std::size_t choose(const Starts<Dim>& starts, const CommandLine& command_line, const std::string& directory,
                   const Optimize<Dim>& optimize, Json& table) {
  const MPI_Comm comm = starts.setup().world();
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < starts.count(); ++k) {
    print(formatted("start %zu of %zu, initial ", k + 1, starts.count()) + starts.name(k) + ": " +
          std::to_string(starts.setup().config.optimizer.max_iterations) + " iterations");
    const CommandLine own = starts.command_line(command_line, directory, k);
    const Json initial = parse_json(starts.name(k), "initial");
    PhaseTimer timer;
    try {
      optimize(own, starts.setup(), timer);
    } catch (const NumericalError& error) {
      if (k + 1 == starts.count() && !best) throw;
      warn("start " + std::to_string(k + 1) + " is left out: " + error.what());
      table.push_back(Json::object({{"initial", initial}, {"failure", error.what()}}));
      continue;
    }
    table.push_back(outcome(comm, *own.output, initial));
    print_outcome(table[k], k);
    if (!best || is_better(table[k], table[*best])) best = k;
  }
  return *best;
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
CommandLine Starts<Dim>::command_line(const CommandLine& whole, const std::string& directory,
                                      std::size_t start) const {
  const MPI_Comm comm = whole_.world();
  const DesignSupport<Dim>& support = whole_.design_support;
  CommandLine result = whole;
  result.output = folder_of_start(directory, start);
  result.start_file = directory + "/" + starts_folder + "/start_" + std::to_string(start + 1) + ".h5";
  if (whole.restart && *whole.restart != "auto") {
    // A start that this run has not come to is a new one.
    const std::string earlier = folder_of_start(*whole.restart, start);
    result.restart = find_checkpoint(comm, earlier).empty() ? "auto" : earlier;
  }
  Hdf5Writer file(comm, *result.start_file);
  file.template write_field<Dim>(whole_.grid,
                                 {"design", support.on_nodes(), support.components(), designs_[start]});
  if (const LayerVariables& variables = whole_.layers->variables(); variables.count() > 0)
    file.write_array(variables.name, variables.start, variables.columns);
  file.close();
  return result;
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
CommandLine begin_with_starts(const std::optional<Starts<Dim>>& starts, const CommandLine& command_line,
                              RunOutput<Dim>& output, const Optimize<Dim>& optimize) {
  CommandLine others = command_line;
  if (command_line.start_file) others.design_file = command_line.start_file;
  if (!starts) return others;
  output.directory().make_folder(starts_folder);
  const std::string& directory = output.directory().path();
  Json table = Json::array();
  std::size_t best = 0;
  before_the_first<Dim>(output, [&] { best = choose(*starts, command_line, directory, optimize, table); });
  for (std::size_t k = 0; k < table.size(); ++k) table[k]["chosen"] = k == best;
  output.set_starts(table);
  print(formatted("start %zu, initial ", best + 1) + starts->name(best) + ", goes on");
  others.design_file = folder_of_start(directory, best) + "/result.h5";
  return others;
}

FABSEQ_INSTANTIATE_CLASS(Starts);
FABSEQ_INSTANTIATE_FUNCTION(make_starts);
FABSEQ_INSTANTIATE_FUNCTION(begin_with_starts);

}  // namespace fabseq
