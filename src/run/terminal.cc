// SPDX-License-Identifier: MIT
#include "fabseq/run/terminal.h"

#include "fabseq/base/session.h"

#include <cstdio>

namespace fabseq {

void print_responses(const SequenceNumbers& numbers) {
  for (const auto& [name, type, value] : numbers.responses)
    print(name + " (" + type + "): " + Json(value).dump());
}

void Terminal::baseline(const SequenceNumbers& planar) {
  planar_objective_ = planar.first_objective();
  char line[160];
  std::snprintf(line, sizeof line, "planar baseline: %zu layers, first objective term %.4e",
                planar.layers.size(), planar_objective_);
  print(line);
}

void Terminal::iteration(const Iterate& iterate, double seconds) {
  const ProblemValues& values = iterate.values;
  ProgressLine line;
  line.iteration = iterate.iteration;
  line.max_iterations = max_iterations_;
  if (!values.objective.empty() && values.objective[0][0] > 0.0)
    line.objective_ratio = planar_objective_ / values.objective[0][0];
  if (!values.constraints.empty()) line.worst_constraint = values.worst_constraint;
  line.beta = iterate.beta;
  line.seconds = seconds;
  progress_.print(line);
}

void Terminal::table(const Summary& summary, const std::string& directory) const {
  print("");
  print("sequence              first objective   planar / this   max displacement   layers");
  const auto print_sequence = [&](const char* name, const SequenceNumbers& numbers) {
    char line[160];
    std::snprintf(line, sizeof line, "%-20s %16.4e %15.1f %18.4e %8d", name, numbers.first_objective(),
                  planar_objective_ / numbers.first_objective(), numbers.displacement_size.largest,
                  numbers.used_layers());
    print(line);
  };
  print_sequence("planar", *summary.baseline);
  print_sequence("optimized", summary.finish->optimized);
  print_sequence("optimized, binary", summary.finish->binary);
  char line[160];
  std::snprintf(line, sizeof line, "%s after %d iterations (%s), best feasible: %s, %.1f s; results in %s",
                summary.end.status.c_str(), summary.end.iterations, summary.end.reason.c_str(),
                summary.finish->best.feasible() ? "yes" : "no", summary.seconds.total, directory.c_str());
  print(line);
}

}  // namespace fabseq
