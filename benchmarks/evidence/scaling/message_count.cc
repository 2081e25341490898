// SPDX-License-Identifier: MIT
/// \file
/// Counts what a run sends, by phase and by design iteration: a library to be preloaded (LD_PRELOAD) under
/// every rank.
///
/// The lane kernels send by plain MPI, PETSc by its own scatters; this sees both, whoever calls. A phase is a
/// stage of PETSc's log ("fabseq primal"), so PetscLogStageRegister, -Push and -Pop are watched, too. Each
/// rank writes MESSAGE_COUNT_DIRECTORY/RANK.csv when it ends:
///
///     iteration,stage,kind,ranks,bytes,count
///
/// `kind` is "message" (counted by its sender) or the name of a collective; `ranks` is the size of the
/// communicator, `bytes` are of one message, or what one rank brings into the collective. Rows of iteration i
/// count what came since iteration i - 1 began its output, up to where iteration i does; the last is the
/// rest.
#ifndef OMPI_SKIP_MPICXX
#define OMPI_SKIP_MPICXX
#endif
#include <mpi.h>

#include <cstdlib>
#include <dlfcn.h>
#include <fstream>
#include <map>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

namespace {

using Key = std::tuple<std::string, std::string, int, long>;  // stage, kind, ranks, bytes
using Counts = std::map<Key, long>;

struct Counter {
  std::map<int, std::string> stage_names{{0, "main"}};
  std::vector<int> stages{0};
  std::vector<Counts> iterations = {{}};
  std::map<MPI_Request, std::pair<int, long>> persistent;  ///< sends: ranks, bytes
};

Counter counter;

int size_of(MPI_Comm comm) {
  int size = 1;
  PMPI_Comm_size(comm, &size);
  return size;
}

long bytes_of(long count, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return count * size;
}

void count(const char* kind, int ranks, long bytes) {
  ++counter.iterations.back()[{counter.stage_names[counter.stages.back()], kind, ranks, bytes}];
}

void count_collective(const char* kind, long items, MPI_Datatype type, MPI_Comm comm) {
  count(kind, size_of(comm), bytes_of(items, type));
}

void count_message(int to, long items, MPI_Datatype type, MPI_Comm comm) {
  if (to != MPI_PROC_NULL) count_collective("message", items, type, comm);
}

void count_start(MPI_Request request) {
  const auto found = counter.persistent.find(request);
  if (found != counter.persistent.end()) count("message", found->second.first, found->second.second);
}

void write() {
  const char* const directory = std::getenv("MESSAGE_COUNT_DIRECTORY");
  if (directory == nullptr) return;
  int rank = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  std::ofstream file(std::string(directory) + "/" + std::to_string(rank) + ".csv");
  file << "iteration,stage,kind,ranks,bytes,count\n";
  int iteration = 0;
  for (const Counts& counts : counter.iterations) {
    ++iteration;
    for (const auto& [key, value] : counts) {
      const auto& [stage, kind, ranks, bytes] = key;
      file << iteration << ',' << stage << ',' << kind << ',' << ranks << ',' << bytes << ',' << value
           << '\n';
    }
  }
}

/// PETSc's own function of this name.
template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int PetscLogStageRegister(const char name[], int* stage) {
  static auto* const original = next<int(const char*, int*)>("PetscLogStageRegister");
  const int status = original(name, stage);
  if (status == 0) counter.stage_names[*stage] = name;
  return status;
}

int PetscLogStagePush(int stage) {
  static auto* const original = next<int(int)>("PetscLogStagePush");
  counter.stages.push_back(stage);
  if (counter.stage_names[stage] == "fabseq output") counter.iterations.emplace_back();
  return original(stage);
}

int PetscLogStagePop() {
  static auto* const original = next<int()>("PetscLogStagePop");
  if (counter.stages.size() > 1) counter.stages.pop_back();
  return original();
}

int MPI_Finalize() {
  write();
  return PMPI_Finalize();
}

/// A call of MPI that is counted first.
#define COUNTED(name, parameters, arguments, counting) \
  int MPI_##name parameters {                          \
    counting;                                          \
    return PMPI_##name arguments;                      \
  }

COUNTED(Send, (const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm),
        (data, n, type, to, tag, comm), count_message(to, n, type, comm))
COUNTED(Isend,
        (const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request),
        (data, n, type, to, tag, comm, request), count_message(to, n, type, comm))
COUNTED(Issend,
        (const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request),
        (data, n, type, to, tag, comm, request), count_message(to, n, type, comm))
COUNTED(Sendrecv,
        (const void* data, int n, MPI_Datatype type, int to, int tag, void* out, int m, MPI_Datatype out_type,
         int from, int out_tag, MPI_Comm comm, MPI_Status* status),
        (data, n, type, to, tag, out, m, out_type, from, out_tag, comm, status),
        count_message(to, n, type, comm))

int MPI_Send_init(const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm,
                  MPI_Request* request) {
  const int status = PMPI_Send_init(data, n, type, to, tag, comm, request);
  if (status == MPI_SUCCESS && to != MPI_PROC_NULL)
    counter.persistent[*request] = {size_of(comm), bytes_of(n, type)};
  return status;
}

int MPI_Request_free(MPI_Request* request) {
  counter.persistent.erase(*request);
  return PMPI_Request_free(request);
}

int MPI_Start(MPI_Request* request) {
  count_start(*request);
  return PMPI_Start(request);
}

int MPI_Startall(int n, MPI_Request requests[]) {
  for (int i = 0; i < n; ++i) count_start(requests[i]);
  return PMPI_Startall(n, requests);
}

COUNTED(Allreduce, (const void* in, void* out, int n, MPI_Datatype type, MPI_Op operation, MPI_Comm comm),
        (in, out, n, type, operation, comm), count_collective("allreduce", n, type, comm))
COUNTED(Iallreduce,
        (const void* in, void* out, int n, MPI_Datatype type, MPI_Op operation, MPI_Comm comm,
         MPI_Request* request),
        (in, out, n, type, operation, comm, request), count_collective("allreduce", n, type, comm))
COUNTED(Reduce,
        (const void* in, void* out, int n, MPI_Datatype type, MPI_Op operation, int root, MPI_Comm comm),
        (in, out, n, type, operation, root, comm), count_collective("reduce", n, type, comm))
COUNTED(Reduce_scatter_block,
        (const void* in, void* out, int n, MPI_Datatype type, MPI_Op operation, MPI_Comm comm),
        (in, out, n, type, operation, comm), count_collective("reduce_scatter", n, type, comm))
COUNTED(Scan, (const void* in, void* out, int n, MPI_Datatype type, MPI_Op operation, MPI_Comm comm),
        (in, out, n, type, operation, comm), count_collective("scan", n, type, comm))
COUNTED(Exscan, (const void* in, void* out, int n, MPI_Datatype type, MPI_Op operation, MPI_Comm comm),
        (in, out, n, type, operation, comm), count_collective("scan", n, type, comm))
COUNTED(Bcast, (void* data, int n, MPI_Datatype type, int root, MPI_Comm comm), (data, n, type, root, comm),
        count_collective("bcast", n, type, comm))
COUNTED(Barrier, (MPI_Comm comm), (comm), count_collective("barrier", 0, MPI_CHAR, comm))
COUNTED(Gather,
        (const void* in, int n, MPI_Datatype type, void* out, int m, MPI_Datatype out_type, int root,
         MPI_Comm comm),
        (in, n, type, out, m, out_type, root, comm), count_collective("gather", n, type, comm))
COUNTED(Gatherv,
        (const void* in, int n, MPI_Datatype type, void* out, const int counts[], const int starts[],
         MPI_Datatype out_type, int root, MPI_Comm comm),
        (in, n, type, out, counts, starts, out_type, root, comm), count_collective("gather", n, type, comm))
COUNTED(Scatterv,
        (const void* in, const int counts[], const int starts[], MPI_Datatype type, void* out, int n,
         MPI_Datatype out_type, int root, MPI_Comm comm),
        (in, counts, starts, type, out, n, out_type, root, comm),
        count_collective("scatter", n, out_type, comm))
COUNTED(Allgather,
        (const void* in, int n, MPI_Datatype type, void* out, int m, MPI_Datatype out_type, MPI_Comm comm),
        (in, n, type, out, m, out_type, comm), count_collective("allgather", n, type, comm))
COUNTED(Allgatherv,
        (const void* in, int n, MPI_Datatype type, void* out, const int counts[], const int starts[],
         MPI_Datatype out_type, MPI_Comm comm),
        (in, n, type, out, counts, starts, out_type, comm), count_collective("allgather", n, type, comm))
COUNTED(Alltoall,
        (const void* in, int n, MPI_Datatype type, void* out, int m, MPI_Datatype out_type, MPI_Comm comm),
        (in, n, type, out, m, out_type, comm),
        count_collective("alltoall", static_cast<long>(n) * size_of(comm), type, comm))
COUNTED(Alltoallv,
        (const void* in, const int counts[], const int starts[], MPI_Datatype type, void* out,
         const int out_counts[], const int out_starts[], MPI_Datatype out_type, MPI_Comm comm),
        (in, counts, starts, type, out, out_counts, out_starts, out_type, comm),
        count_collective("alltoallv", std::accumulate(counts, counts + size_of(comm), 0L), type, comm))

}  // extern "C"
