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

void History::append(const Json& entry) const { directory_.append_line(history_file, to_text(entry)); }

std::int64_t History::sync() const {
  std::int64_t size = 0;
  run_on_first(directory_.comm(), [&] { size = sync_file(directory_.file(history_file)); });
  return sum(directory_.comm(), size);
}

void History::cut_back(std::int64_t position) const {
  std::int64_t size = 0;
  run_on_first(directory_.comm(), [&] { size = sync_file(directory_.file(history_file), position); });
  warn_if_short(directory_.comm(), size, position);
}

void History::copy_from(const std::string& directory, std::int64_t position) const {
  std::int64_t size = 0;
  run_on_first(directory_.comm(), [&] {
    std::string text = read_file_if_there(directory + "/" + history_file);
    text.resize(std::min(text.size(), static_cast<std::size_t>(position)));
    size = static_cast<std::int64_t>(text.size());
    if (!text.empty()) replace_file(directory_.file(history_file), text);
  });
  warn_if_short(directory_.comm(), size, position);
}

}  // namespace fabseq
