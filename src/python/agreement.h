// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/session.h"
#include "fabseq/keys/message.h"
#include "python/failure.h"

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

namespace fabseq {

/// A call of the module: what all ranks must have in common before any of them begins its work.
struct Call {
  std::string name;                 ///< such as "evaluate"
  int problem = 0;                  ///< number of the problem, in the order in which they were made, from 1
  Json arguments = Json::object();  ///< those that must be equal
};

/// Keeps the ranks together in calls of the module. A Python program may raise an exception on one rank, or
/// give ranks different arguments: without this, the others would wait forever. The ranks talk through a
/// communicator of their own, so that they meet no other messages. Constructor and destructor are collective
/// on `world`.
class Agreement {
 public:
  explicit Agreement(MPI_Comm world) : own_(world, 0, rank_of(world)) {}

  /// Does a call on all ranks: `prepare` reads the arguments of this rank, `work` is the rest. What either
  /// throws on one rank is thrown on all.
  void run(const std::function<Call()>& prepare, const std::function<void()>& work) const {
    if (size_of(own_) == 1) {
      (void)prepare();
      return work();
    }
    Call call;
    const std::optional<Failure> wrong = outcome_of([&] { call = prepare(); });
    require_same(call, wrong);
    leave(outcome_of(work));
  }

  /// Waits until all ranks are here. Whoever makes another call meanwhile gets an exception instead.
  void end() const {
    bool is_end = false;
    while (!is_end) is_end = !outcome_of([&] { require_same({"the end of the program"}, std::nullopt); });
  }

 private:
  /// How long a rank that has failed waits for the others to come out of their call, too.
  static constexpr std::chrono::seconds patience{30};

  static std::optional<Failure> outcome_of(const std::function<void()>& work) {
    try {
      work();
      return std::nullopt;
    } catch (...) {
      return failure_of(std::current_exception());
    }
  }

  /// Throws on all ranks if one of them is `wrong`, or in another call, or has other arguments.
  void require_same(const Call& call, const std::optional<Failure>& wrong) const {
    const std::string text = to_text(Json::array({call.name, call.problem, call.arguments}));
    const auto sum = static_cast<std::int64_t>(std::hash<std::string>()(text));
    const std::vector<std::int64_t> found = gather_all(own_, std::vector<std::int64_t>{sum, wrong ? 1 : 0});
    std::vector<int> failed;
    bool same = true;
    for (std::size_t i = 0; i < found.size(); i += 2) {
      failed.push_back(static_cast<int>(found[i + 1]));
      same = same && found[i] == found[0];
    }
    throw_first(failed, wrong);
    if (same) return;
    const Json first = Json::parse(broadcast(own_, text));
    const std::string difference = difference_from(first, call);
    const std::int64_t nobody = size_of(own_);
    const std::int64_t other = min(own_, difference.empty() ? nobody : std::int64_t{rank_of(own_)});
    if (other == nobody) return;  // the members of a dict stand in another order
    const bool other_call = first[0] != call.name || first[1] != call.problem;
    throw SharedFailure({any(own_, other_call) ? "RuntimeError" : "ValueError",
                         broadcast(own_, difference, static_cast<int>(other))});
  }

  /// Throws on all ranks if the call has failed on one of them. Those that have not failed come here once
  /// they are done. If they wait within the call for the one that has, the run ends.
  void leave(const std::optional<Failure>& failure) const {
    const int own = failure ? 1 : 0;
    std::vector<int> failed(static_cast<std::size_t>(size_of(own_)));
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Iallgather(&own, 1, MPI_INT, failed.data(), 1, MPI_INT, own_, &request);
    const auto end = std::chrono::steady_clock::now() + patience;
    int done = 0;
    for (MPI_Test(&request, &done, MPI_STATUS_IGNORE); failure && done == 0;
         MPI_Test(&request, &done, MPI_STATUS_IGNORE)) {
      if (std::chrono::steady_clock::now() > end) {
        write_text(STDERR_FILENO,
                   "fabseq: rank " + std::to_string(rank_of(own_)) + ": " + failure->message + '\n');
        MPI_Abort(MPI_COMM_WORLD, 1);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (done == 0) MPI_Wait(&request, MPI_STATUS_IGNORE);
    throw_first(failed, failure);
  }

  /// Throws what the first rank that has failed says, on all ranks. `failed`: 1 for those that have.
  void throw_first(const std::vector<int>& failed, const std::optional<Failure>& own) const {
    const auto first = std::find(failed.begin(), failed.end(), 1);
    if (first == failed.end()) return;
    const auto rank = static_cast<int>(first - failed.begin());
    const Failure mine = own.value_or(Failure{});
    Failure of_first{broadcast(own_, mine.type, rank), broadcast(own_, mine.message, rank)};
    if (std::find(failed.begin(), failed.end(), 0) != failed.end())
      of_first.message = "rank " + std::to_string(rank) + ": " + of_first.message;
    throw SharedFailure(of_first);
  }

  /// How a call differs from that of rank 0, as a message; "" if it does not.
  std::string difference_from(const Json& first, const Call& call) const {
    const std::string here = " on rank " + std::to_string(rank_of(own_));
    const auto named = [](const std::string& name, int problem) {
      return name + (problem > 0 ? " of problem " + std::to_string(problem) : "");
    };
    const std::string other = named(first[0].get<std::string>(), first[1].get<int>());
    if (const std::string own = named(call.name, call.problem); own != other)
      return "found " + own + here + " and " + other + " on rank 0; allowed: the same call on all ranks";
    const std::string found = value_difference(&first[2], &call.arguments, here, "");
    return found.empty() ? "" : call.name + ": " + found + " on rank 0; allowed: the same on all ranks";
  }
  /// The first place where two values differ, with both; "" if there is none.
  static std::string value_difference(const Json* first, const Json* own, const std::string& here,
                                      const std::string& pointer) {
    const auto text = [](const Json* value) { return value == nullptr ? "nothing" : shown(*value); };
    std::string found;
    if (first != nullptr && own != nullptr && first->is_object() && own->is_object()) {
      Json of_both = *first;
      of_both.update(*own);
      for (auto it = of_both.begin(); found.empty() && it != of_both.end(); ++it)
        found = value_difference(find_member(*first, it.key()), find_member(*own, it.key()), here,
                                 pointer_to(pointer, it.key()));
      return found;
    }
    const bool same = first != nullptr && own != nullptr && *first == *own;
    return same ? "" : pointer + ": found " + text(own) + here + " and " + text(first);
  }

  Communicator own_;
};

}  // namespace fabseq
