// SPDX-License-Identifier: MIT
#include "fabseq/base/mpi.h"

#include "fabseq/base/error.h"
#include "fabseq/base/petsc.h"  // so that -log_view counts the messages sent here

#include <limits>
#include <numeric>

namespace fabseq {

namespace {

template <class T>
T reduce(MPI_Comm comm, T value, MPI_Datatype type, MPI_Op operation) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, type, operation, comm);
  return value;
}

template <class T>
void reduce(MPI_Comm comm, std::span<T> values, MPI_Datatype type, MPI_Op operation) {
  for_each_message(values, [&](std::span<T> part) {
    MPI_Allreduce(MPI_IN_PLACE, part.data(), static_cast<int>(part.size()), type, operation, comm);
  });
}

template <class T>
std::vector<T> gather(MPI_Comm comm, std::span<const T> own, MPI_Datatype type) {
  // Without a sum of its own: a count that an int cannot hold is sent as -1.
  constexpr std::size_t most = std::numeric_limits<int>::max();
  const int count = own.size() > most ? -1 : static_cast<int>(own.size());
  std::vector<int> counts(static_cast<std::size_t>(size_of(comm))), starts(counts);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::int64_t total = 0;
  for (const int of_rank : counts) total += of_rank < 0 ? static_cast<std::int64_t>(most) + 1 : of_rank;
  if (total > static_cast<std::int64_t>(most))
    throw InputError("a list of " + std::to_string(total) + " entries or more on all ranks, at most " +
                     std::to_string(most) + " are allowed: use a coarser grid or fewer nodes");
  std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
  std::vector<T> all(static_cast<std::size_t>(total));
  MPI_Allgatherv(own.data(), count, type, all.data(), counts.data(), starts.data(), type, comm);
  return all;
}

}  // namespace

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int size_of(MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

double sum(MPI_Comm comm, double value) { return reduce(comm, value, MPI_DOUBLE, MPI_SUM); }
std::int64_t sum(MPI_Comm comm, std::int64_t value) { return reduce(comm, value, MPI_INT64_T, MPI_SUM); }
double max(MPI_Comm comm, double value) { return reduce(comm, value, MPI_DOUBLE, MPI_MAX); }
std::int64_t max(MPI_Comm comm, std::int64_t value) { return reduce(comm, value, MPI_INT64_T, MPI_MAX); }
double min(MPI_Comm comm, double value) { return reduce(comm, value, MPI_DOUBLE, MPI_MIN); }
std::int64_t min(MPI_Comm comm, std::int64_t value) { return reduce(comm, value, MPI_INT64_T, MPI_MIN); }

bool any(MPI_Comm comm, bool value) { return reduce(comm, value ? 1 : 0, MPI_INT, MPI_MAX) != 0; }

void sum_in_place(MPI_Comm comm, std::span<double> values) { reduce(comm, values, MPI_DOUBLE, MPI_SUM); }
void sum_in_place(MPI_Comm comm, std::span<float> values) { reduce(comm, values, MPI_FLOAT, MPI_SUM); }
void sum_in_place(MPI_Comm comm, std::span<std::int64_t> values) {
  reduce(comm, values, MPI_INT64_T, MPI_SUM);
}
void sum_in_place(MPI_Comm comm, std::span<int> values) { reduce(comm, values, MPI_INT, MPI_SUM); }
void max_in_place(MPI_Comm comm, std::span<double> values) { reduce(comm, values, MPI_DOUBLE, MPI_MAX); }

std::vector<std::int64_t> gather_all(MPI_Comm comm, std::span<const std::int64_t> own) {
  return gather(comm, own, MPI_INT64_T);
}
std::vector<double> gather_all(MPI_Comm comm, std::span<const double> own) {
  return gather(comm, own, MPI_DOUBLE);
}

std::string broadcast(MPI_Comm comm, const std::string& text, int root) {
  auto length = static_cast<std::int64_t>(text.size());
  MPI_Bcast(&length, 1, MPI_INT64_T, root, comm);
  std::string result = text;
  result.resize(static_cast<std::size_t>(length));
  MPI_Bcast(result.data(), static_cast<int>(length), MPI_CHAR, root, comm);
  return result;
}

void broadcast(MPI_Comm comm, std::span<double> values, int root) {
  for_each_message(values, [&](std::span<double> part) {
    MPI_Bcast(part.data(), static_cast<int>(part.size()), MPI_DOUBLE, root, comm);
  });
}

std::int64_t exclusive_sum(MPI_Comm comm, std::int64_t value) {
  std::int64_t result = 0;
  MPI_Exscan(&value, &result, 1, MPI_INT64_T, MPI_SUM, comm);
  return rank_of(comm) == 0 ? 0 : result;
}

}  // namespace fabseq
