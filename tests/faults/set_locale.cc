// SPDX-License-Identifier: MIT
/// \file
/// Sets the locale that OTHER_LOCALE names before main(), as a library of others may do: to be preloaded
/// (LD_PRELOAD) under a run.
#include <cstdio>
#include <cstdlib>
#include <locale>

namespace {

[[gnu::constructor]] void set_locale() {
  const char* name = std::getenv("OTHER_LOCALE");
  if (name == nullptr) return;
  std::locale::global(std::locale(name));  // of C, too
  char text[8];
  (void)std::snprintf(text, sizeof text, "%.1f", 0.5);
  if (text[1] == '.') std::abort();  // then nothing would be tested
}

}  // namespace
