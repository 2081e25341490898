// SPDX-License-Identifier: MIT
#include "fabseq/base/large_pages.h"

#include <cstdint>
#include <new>
#include <sys/mman.h>

namespace fabseq {

namespace {

std::size_t rounded_up(std::size_t bytes) { return (bytes + large_page - 1) / large_page * large_page; }

}  // namespace

/// Maps a page more than is needed and gives back what lies before and behind the aligned part.
void* map_large_pages(std::size_t bytes) {
  const std::size_t size = rounded_up(bytes);
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

void unmap_large_pages(void* place, std::size_t bytes) { munmap(place, rounded_up(bytes)); }

}  // namespace fabseq
