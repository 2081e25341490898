// SPDX-License-Identifier: MIT
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace fabseq {

/// Lifetime over which this thread's results and operands below the normal range (1e-38 in single precision)
/// count as zero, where the processor can do so: far from a layer, residuals in single precision get that
/// small, and calculating with what is left of them takes a hundred times as long.
class FlushToZero {
 public:
#if defined(__SSE2__)
  FlushToZero() : before_(_mm_getcsr()) { _mm_setcsr(before_ | results | operands); }
  ~FlushToZero() { _mm_setcsr(before_); }
#else
  FlushToZero() = default;
#endif
  FlushToZero(FlushToZero&&) = delete;

#if defined(__SSE2__)
 private:
  static constexpr unsigned results = 0x8000, operands = 0x0040;
  unsigned before_;
#endif
};

}  // namespace fabseq
