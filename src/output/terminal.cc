// SPDX-License-Identifier: MIT
#include "fabseq/output/terminal.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/plain_numbers.h"
#include "fabseq/base/session.h"
#include "fabseq/output/summary_table.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

namespace fabseq {

namespace {

std::string duration_text(double seconds) {
  const auto total = static_cast<long long>(std::llround(std::clamp(seconds, 0.0, 1e9)));
  return formatted("%lld:%02lld:%02lld", total / 3600, total / 60 % 60, total % 60);
}

/// Parent of a process, 0 if unknown.
int parent_of(int process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  std::string word;
  while (status >> word)
    if (word == "PPid:") return status >> word ? number_in<int>(word).value_or(0) : 0;
  return 0;
}

/// Looks at the output of the nearest ancestor that does not share ours: mpirun, above the scripts it may
/// have started.
bool launcher_has_terminal() {
  struct stat ours {};
  if (fstat(STDOUT_FILENO, &ours) != 0) return false;
  for (int process = getppid(); process > 1; process = parent_of(process)) {
    const std::string output = "/proc/" + std::to_string(process) + "/fd/1";
    struct stat theirs {};
    if (stat(output.c_str(), &theirs) != 0) return false;
    if (S_ISCHR(theirs.st_mode) && theirs.st_rdev == ours.st_rdev) continue;
    const int descriptor = open(output.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
    const bool result = descriptor >= 0 && isatty(descriptor) != 0;
    if (descriptor >= 0) (void)close(descriptor);
    return result;
  }
  return false;
}

/// What is left to be mended: places, where the iterate was judged by the exact checks.
std::string limits_text(const Iterate& iterate) {
  if (iterate.binary && iterate.binary->beyond_limits) {
    const std::int64_t places = iterate.binary->beyond_limits->places;
    return places == 0 ? "  buildable"
                       : "  " + std::to_string(places) + (places == 1 ? " place left" : " places left");
  }
  if (iterate.values.constraints.empty()) return "";
  return iterate.values.worst_constraint > 0.0 ? "  limits missed" : "  limits kept";
}

/// "constraint_0" of "constraint_0_3".
std::string response_name(const std::string& component) {
  return component.substr(0, component.find('_', component.find('_') + 1));
}

}  // namespace

bool stdout_is_terminal() {
  if (isatty(STDOUT_FILENO) == 0) return false;
  if (std::getenv("OMPI_COMM_WORLD_SIZE") == nullptr) return true;
  return launcher_has_terminal();
}

void print_responses(const SequenceNumbers& numbers) {
  const auto& all = numbers.responses;
  for (auto first = all.begin(), last = first; first != all.end(); first = last) {
    const std::string name = response_name(first->name);
    last =
        std::find_if(first, all.end(), [&](const auto& value) { return response_name(value.name) != name; });
    const auto [least, most] =
        std::minmax_element(first, last, [](const auto& a, const auto& b) { return a.value < b.value; });
    const std::string label = name + " (" + first->type + "): ";
    print(label + (last - first == 1
                       ? formatted("%.8g", first->value)
                       : formatted("%.6g to %.6g, %td components", least->value, most->value, last - first)));
  }
}

void print_words(const SequenceNumbers& numbers, const std::string& finding) {
  for (const std::string& sentence : numbers.found.words_of(finding)) print(sentence);
}

Terminal::Terminal(MPI_Comm comm, int max_iterations, bool on_terminal)
    : is_first_(rank_of(comm) == 0), max_iterations_(max_iterations), on_terminal_(on_terminal) {}

void Terminal::baseline(const SequenceNumbers& planar) {
  planar_objective_ = planar.first_objective();
  const bool is_defined = std::isfinite(planar_objective_);  // not so for alignment of sub-parts
  print("planar baseline: " + std::to_string(planar.layers.size()) + " layers" +
        (is_defined ? formatted(", first objective term %.4e", planar_objective_) : ""));
}

std::string Terminal::progress_text(const Iterate& iterate, double seconds) const {
  const ProblemValues& values = iterate.values;
  const int width = static_cast<int>(std::to_string(max_iterations_).size());
  const bool repairs = iterate.iteration > max_iterations_;
  std::string text = repairs ? formatted("repair %*d", width, iterate.iteration - max_iterations_)
                             : formatted("iteration %*d/%d", width, iterate.iteration, max_iterations_);
  const double objective = values.objective.empty() ? 0.0 : values.objective[0][0];
  if (objective > 0.0 && !std::isnan(planar_objective_))
    text += formatted("  planar/objective %.4g", planar_objective_ / objective);
  text += limits_text(iterate);
  text += formatted("  beta %.4g  %.3g s/iteration", iterate.beta, seconds);
  return repairs ? text
                 : text + "  left " + duration_text(mean_seconds_ * (max_iterations_ - iterate.iteration));
}

void Terminal::iteration(const Iterate& iterate, double seconds) {
  // The last iterations count most: what one costs changes along the way.
  constexpr double memory = 0.8;
  mean_seconds_ = mean_seconds_ == 0.0 ? seconds : memory * mean_seconds_ + (1.0 - memory) * seconds;
  if (!is_first_) return;
  const std::string text = progress_text(iterate, seconds);
  // The escape clears what is left of a longer line.
  write_text(STDOUT_FILENO, on_terminal_ ? "\r" + text + "\033[K" : text + "\n");
  line_open_ = on_terminal_;
}

void Terminal::end_progress() {
  if (!line_open_) return;
  write_text(STDOUT_FILENO, "\n");
  line_open_ = false;
}

void Terminal::table(const Summary& summary, const std::string& directory) const {
  print("");
  for (const std::string& line : summary_table(summary)) print(line);
  const auto& miss = summary.finish->reports.miss;
  const bool feasible = summary.finish->best.feasible();
  const bool done = summary.end.status == "converged" || summary.end.status == "iteration_limit";
  print((done ? "done" : summary.end.status) + " after " + std::to_string(summary.end.iterations) +
        " iterations (" + summary.end.reason + "), " + formatted("%.1f s", summary.seconds.total) +
        (miss && !feasible ? "; constraint " + miss->words : ""));
  print(
      "all figures: summary.json, fields: result.h5 (ParaView: result.xdmf), pictures: fabseq-tools report; "
      "in " +
      directory);
}

}  // namespace fabseq
