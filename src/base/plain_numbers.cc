// SPDX-License-Identifier: MIT
#include "fabseq/base/plain_numbers.h"

#include <new>

namespace fabseq {

namespace {

/// The locale of this thread, but for its numbers.
locale_t plain_locale() {
  const locale_t copy = ::duplocale(::uselocale(nullptr));
  if (copy == nullptr) throw std::bad_alloc();
  const locale_t plain = ::newlocale(LC_NUMERIC_MASK, "C", copy);
  if (plain != nullptr) return plain;
  ::freelocale(copy);
  throw std::bad_alloc();
}

}  // namespace

PlainNumbers::PlainNumbers() : plain_(plain_locale()), previous_(::uselocale(plain_)) {}

PlainNumbers::~PlainNumbers() {
  (void)::uselocale(previous_);
  ::freelocale(plain_);
}

}  // namespace fabseq
