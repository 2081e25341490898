// SPDX-License-Identifier: MIT
#include "fabseq/base/mpi.h"

#include "fabseq/base/petsc.h"  // -log_view counts what is sent here

namespace fabseq {

namespace {

template <class T>
T reduce(MPI_Comm comm, T value, MPI_Datatype type, MPI_Op operation) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, type, operation, comm);
  return value;
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

void sum_in_place(MPI_Comm comm, std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm);
}

void sum_in_place(MPI_Comm comm, std::span<float> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_FLOAT, MPI_SUM, comm);
}

void sum_in_place(MPI_Comm comm, std::span<std::int64_t> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT64_T, MPI_SUM, comm);
}

void sum_in_place(MPI_Comm comm, std::span<int> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT, MPI_SUM, comm);
}

void max_in_place(MPI_Comm comm, std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX, comm);
}

std::string broadcast(MPI_Comm comm, const std::string& text) {
  auto length = static_cast<std::int64_t>(text.size());
  MPI_Bcast(&length, 1, MPI_INT64_T, 0, comm);
  std::string result = text;
  result.resize(static_cast<std::size_t>(length));
  MPI_Bcast(result.data(), static_cast<int>(length), MPI_CHAR, 0, comm);
  return result;
}

void broadcast(MPI_Comm comm, std::span<double> values) {
  MPI_Bcast(values.data(), static_cast<int>(values.size()), MPI_DOUBLE, 0, comm);
}

std::int64_t exclusive_sum(MPI_Comm comm, std::int64_t value) {
  std::int64_t result = 0;
  MPI_Exscan(&value, &result, 1, MPI_INT64_T, MPI_SUM, comm);
  return rank_of(comm) == 0 ? 0 : result;
}

}  // namespace fabseq
