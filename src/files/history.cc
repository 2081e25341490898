// SPDX-License-Identifier: MIT
#include "fabseq/files/history.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"

#include <algorithm>

namespace fabseq {

namespace {

constexpr const char* name = "history.jsonl";

void warn_if_short(MPI_Comm comm, std::int64_t size, std::int64_t position) {
  if (any(comm, rank_of(comm) == 0 && size < position))
    warn(std::string(name) + " has lost lines that belong to the checkpoint; the run continues without them");
}

}  // namespace

void History::append(const Json& entry) const { directory_.append_line(name, to_text(entry)); }

std::int64_t History::sync() const {
  std::int64_t size = 0;
  run_on_first(directory_.comm(), [&] { size = sync_file(directory_.file(name)); });
  return sum(directory_.comm(), size);
}

void History::cut_back(std::int64_t position) const {
  std::int64_t size = 0;
  run_on_first(directory_.comm(), [&] { size = cut_file(directory_.file(name), position); });
  warn_if_short(directory_.comm(), size, position);
}

void History::copy_from(const std::string& directory, std::int64_t position) const {
  std::int64_t size = 0;
  run_on_first(directory_.comm(), [&] {
    std::string text = read_file_if_there(directory + "/" + name);
    text.resize(std::min(text.size(), static_cast<std::size_t>(position)));
    size = static_cast<std::int64_t>(text.size());
    if (!text.empty()) replace_file(directory_.file(name), text);
  });
  warn_if_short(directory_.comm(), size, position);
}

}  // namespace fabseq
