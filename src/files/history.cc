// SPDX-License-Identifier: MIT
#include "fabseq/files/history.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"

#include <algorithm>

namespace fabseq {

namespace {

constexpr const char* history_file = "history.jsonl";

void warn_if_short(MPI_Comm comm, std::int64_t size, std::int64_t position) {
  if (any(comm, rank_of(comm) == 0 && size < position))
    warn(std::string(history_file) +
         " has lost lines that belong to the checkpoint; the run continues without them");
}

}  // namespace

void append_to_history(const OutputDirectory& directory, const Json& entry) {
  run_on_first(directory.comm(),
               [&] { append_to_file(directory.file(history_file), to_text(entry) + "\n"); });
}

std::int64_t sync_history(const OutputDirectory& directory) {
  std::int64_t size = 0;
  run_on_first(directory.comm(), [&] { size = sync_file(directory.file(history_file)); });
  return sum(directory.comm(), size);
}

void cut_history(const OutputDirectory& directory, std::int64_t position) {
  std::int64_t size = 0;
  run_on_first(directory.comm(), [&] { size = sync_file(directory.file(history_file), position); });
  warn_if_short(directory.comm(), size, position);
}

void copy_history(const OutputDirectory& directory, const std::string& other, std::int64_t position) {
  std::int64_t size = 0;
  run_on_first(directory.comm(), [&] {
    std::string text = read_file_if_there(other + "/" + history_file);
    text.resize(std::min(text.size(), static_cast<std::size_t>(position)));
    size = static_cast<std::int64_t>(text.size());
    if (!text.empty()) replace_file(directory.file(history_file), text);
  });
  warn_if_short(directory.comm(), size, position);
}

}  // namespace fabseq
