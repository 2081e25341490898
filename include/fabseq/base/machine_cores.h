// SPDX-License-Identifier: MIT
/// \file
/// The cores that a run has, and how busy they are. Calls with a `comm` are collective on it and return the
/// same value on all of its ranks.
#pragma once

#include <mpi.h>

#include <optional>
#include <span>
#include <string>

namespace fabseq {

/// What the ranks of a run may use on one node, a machine with a memory of its own. Cores that a launcher,
/// a batch system or a container keeps from all of its ranks do not count.
struct NodeCores {
  int cores = 0;       ///< physical ones, as hwloc sees them
  int threads = 0;     ///< hardware threads, of which a core has one or more
  int ranks = 1;       ///< on this node
  int nodes = 1;       ///< of the run
  double quota = 0.0;  ///< so many cores' time a container or a batch system gives; 0: no limit
  /// Cores that the ranks can keep busy at once.
  double usable() const { return quota > 0.0 && quota < cores ? quota : cores; }
  /// Cores that a rank has for itself; at most 1, since a rank computes on one core.
  double per_rank() const { return ranks > usable() ? usable() / ranks : 1.0; }
};

/// Returns the counts of the node with the fewest cores per rank.
NodeCores fewest_cores(MPI_Comm comm);
/// The one of these nodes, of which there is at least one, with the fewest cores per rank; the first of
/// several.
NodeCores fullest(std::span<const NodeCores> nodes);

/// Share of their time, 0 to 1, that the hardware threads of the ranks are busy with other work, on the
/// busiest node: over a tenth of a second, for which the ranks sleep. Nothing where the system does not tell.
std::optional<double> busy_share(MPI_Comm comm);

/// Describes the cores, such as "2 cores (4 threads) for 2 ranks, 35 % busy", or "2 cores (4 threads), but
/// the time of 0.5 (a limit of the container or the job), for 2 ranks, 35 % busy".
std::string machine_text(const NodeCores& cores, std::optional<double> busy);
std::string machine_text(MPI_Comm comm);

}  // namespace fabseq
