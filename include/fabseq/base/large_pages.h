// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace fabseq {

/// Bytes of a large page.
constexpr std::size_t large_page = std::size_t{1} << 21;

/// Memory apart from the heap, aligned to a large page, on large pages if the system grants them: a piece
/// that was kept, whatever is in it, or a zeroed one from the system. Throws std::bad_alloc. To be given back
/// by unmap_large_pages().
void* map_large_pages(std::size_t bytes);
/// Gives a piece of map_large_pages() back to the system, or keeps it (KeptLargePages).
void unmap_large_pages(void* place);

/// Lifetime over which pieces that are given back are kept for the next to come, since the system clears
/// every page that it grants. For each new piece from the system, the largest kept one, which was too small,
/// goes back. Local to the rank.
class KeptLargePages {
 public:
  KeptLargePages();
  ~KeptLargePages();
  KeptLargePages(const KeptLargePages&) = delete;
  KeptLargePages& operator=(const KeptLargePages&) = delete;

  /// Gives all kept pieces back to the system.
  static void drop();
};

}  // namespace fabseq
