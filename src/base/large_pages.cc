// SPDX-License-Identifier: MIT
#include "fabseq/base/large_pages.h"

#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>
#include <new>
#include <sys/mman.h>

namespace fabseq {

namespace {

std::size_t rounded_up(std::size_t bytes) { return (bytes + large_page - 1) / large_page * large_page; }

/// Maps a page more than is needed and gives back what lies before and behind the aligned part.
void* map_aligned(std::size_t size) {
  void* const mapped =
      mmap(nullptr, size + large_page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  char* const begin = static_cast<char*>(mapped);
  const std::size_t before =
      rounded_up(reinterpret_cast<std::uintptr_t>(begin)) - reinterpret_cast<std::uintptr_t>(begin);
  if (before > 0) munmap(begin, before);
  char* const place = begin + before;
  if (before < large_page) munmap(place + size, large_page - before);
  madvise(place, size, MADV_HUGEPAGE);  // a system without large pages refuses, which does no harm
  return place;
}

/// All pieces of this process.
class Pieces {
 public:
  /// The smallest kept one that is large enough. Where there is none, the largest of the kept goes for the
  /// new one: it has served a smaller array of the kind.
  void* take(std::size_t size) {
    const std::lock_guard lock(mutex_);
    auto found = kept_.lower_bound(size);
    if (found == kept_.end()) {
      if (!kept_.empty()) give_back(std::prev(kept_.end()));
      found = kept_.emplace(size, map_aligned(size));
    }
    void* const place = found->second;
    sizes_.emplace(place, found->first);
    kept_.erase(found);
    return place;
  }

  void put(void* place) {
    const std::lock_guard lock(mutex_);
    const auto found = sizes_.find(place);
    const auto kept = kept_.emplace(found->second, place);
    sizes_.erase(found);
    if (keepers_ == 0) give_back(kept);
  }

  void drop() {
    const std::lock_guard lock(mutex_);
    while (!kept_.empty()) give_back(kept_.begin());
  }

  void add_keepers(int count) {
    const std::lock_guard lock(mutex_);
    keepers_ += count;
  }

 private:
  using Kept = std::multimap<std::size_t, void*>;

  void give_back(Kept::iterator piece) {
    munmap(piece->second, piece->first);
    kept_.erase(piece);
  }

  std::mutex mutex_;
  std::map<void*, std::size_t> sizes_;  ///< of those in use
  Kept kept_;                           ///< by their sizes
  int keepers_ = 0;
};

Pieces& pieces() {
  static Pieces result;
  return result;
}

}  // namespace

void* map_large_pages(std::size_t bytes) { return pieces().take(rounded_up(bytes)); }

void unmap_large_pages(void* place) { pieces().put(place); }

KeptLargePages::KeptLargePages() { pieces().add_keepers(1); }

KeptLargePages::~KeptLargePages() { pieces().add_keepers(-1); }

void KeptLargePages::drop() { pieces().drop(); }

}  // namespace fabseq
