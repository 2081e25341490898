// SPDX-License-Identifier: MIT
#include "fabseq/base/machine_cores.h"

#include "base/busy_time.h"
#include "base/control_group.h"
#include "base/core_count.h"
#include "base/node_ranks.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <span>
#include <thread>
#include <unistd.h>
#include <vector>

namespace fabseq {

namespace {

using std::chrono::milliseconds;

/// Times for which the first rank of a node looks, and the others sleep, so that they begin to wait for it,
/// which takes a core, when it has looked. Linux counts in hundredths of a second.
constexpr milliseconds looking{80}, sleeping{100};

ThreadSet threads_of_node(const NodeRanks& node) {
  ThreadSet result = threads_of_process();
  result.unite(node.comm());
  return result;
}

std::string counted_times() {
  std::ifstream file("/proc/stat");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// What is running now: the load average of a minute would blame others for this run's own start, or for a
/// build that has just ended. It is better than nothing where a container hides the times of its threads.
std::optional<double> measured_share(const ThreadSet& threads) {
  const std::string before = counted_times();
  std::this_thread::sleep_for(looking);
  if (const auto share = busy_share_between(before, counted_times(), threads)) return share;
  double load = 0.0;
  const long online = ::sysconf(_SC_NPROCESSORS_ONLN);
  if (::getloadavg(&load, 1) != 1 || online < 1) return std::nullopt;
  return std::min(1.0, load / static_cast<double>(online));
}

std::string counted(int count, const char* what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

}  // namespace

NodeCores fewest_cores(MPI_Comm comm) {
  const NodeRanks node(comm);
  const ThreadSet threads = threads_of_node(node);
  std::vector<double> own;
  if (node.is_first()) {
    const CoreCount count = count_cores(threads);
    own = {static_cast<double>(count.cores), static_cast<double>(count.threads),
           static_cast<double>(node.count()), cpu_quota().value_or(0.0)};
  }
  const std::vector<double> all = gather_all(comm, own);
  std::vector<NodeCores> nodes;
  const auto count = static_cast<int>(all.size() / 4);
  for (auto of = all.begin(); of != all.end(); of += 4)
    nodes.push_back(
        {static_cast<int>(of[0]), static_cast<int>(of[1]), static_cast<int>(of[2]), count, of[3]});
  return fullest(nodes);
}

NodeCores fullest(std::span<const NodeCores> nodes) {
  return *std::min_element(nodes.begin(), nodes.end(), [](const NodeCores& a, const NodeCores& b) {
    return a.usable() * b.ranks < b.usable() * a.ranks;
  });
}

std::optional<double> busy_share(MPI_Comm comm) {
  const NodeRanks node(comm);
  const ThreadSet threads = threads_of_node(node);
  constexpr double unknown = -1.0;
  double share = unknown;
  MPI_Barrier(comm);
  if (node.is_first())
    share = measured_share(threads).value_or(unknown);
  else
    std::this_thread::sleep_for(sleeping);
  share = max(comm, share);
  return share == unknown ? std::nullopt : std::optional<double>(share);
}

std::string machine_text(const NodeCores& cores, std::optional<double> busy) {
  std::string result = counted(cores.cores, "core") + " (" + counted(cores.threads, "thread") + ")";
  if (cores.usable() < cores.cores)
    result += formatted(", but the time of %.3g (a limit of the container or the job),", cores.quota);
  result += " for " + counted(cores.ranks, "rank");
  if (cores.nodes > 1) result = std::to_string(cores.nodes) + " nodes, the fullest with " + result;
  return busy ? result + formatted(", %.0f %% busy", 100.0 * *busy) : result;
}

std::string machine_text(MPI_Comm comm) {
  const NodeCores cores = fewest_cores(comm);
  return machine_text(cores, busy_share(comm));
}

}  // namespace fabseq
