/// \file
/// The few MPI reductions fabseq needs, on values and in place on arrays. All are collective on `comm`.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <span>
#include <string>

namespace fabseq {

int rank_of(MPI_Comm comm);
int size_of(MPI_Comm comm);

double sum(MPI_Comm comm, double value);
std::int64_t sum(MPI_Comm comm, std::int64_t value);
double max(MPI_Comm comm, double value);
std::int64_t max(MPI_Comm comm, std::int64_t value);
double min(MPI_Comm comm, double value);
std::int64_t min(MPI_Comm comm, std::int64_t value);
/// True on every rank if `value` is true on any.
bool any(MPI_Comm comm, bool value);

/// Sum over the ranks, entry by entry, in place; the same length on all ranks.
void sum_in_place(MPI_Comm comm, std::span<double> values);
void sum_in_place(MPI_Comm comm, std::span<float> values);
void sum_in_place(MPI_Comm comm, std::span<std::int64_t> values);

/// `text` of rank 0 on every rank.
std::string broadcast(MPI_Comm comm, const std::string& text);

/// Sum of `value` over the ranks below this one.
std::int64_t exclusive_sum(MPI_Comm comm, std::int64_t value);

}  // namespace fabseq
