// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace fabseq {

/// Bytes of a large page.
constexpr std::size_t large_page = std::size_t{1} << 21;

/// Zeroed memory apart from the heap, aligned to a large page, on large pages if the system grants them.
/// Throws std::bad_alloc. To be given back by unmap_large_pages() with the same number of bytes.
void* map_large_pages(std::size_t bytes);
void unmap_large_pages(void* place, std::size_t bytes);

}  // namespace fabseq
