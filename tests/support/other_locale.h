// SPDX-License-Identifier: MIT
/// \file
/// Locales that write numbers otherwise, made for a test whether or not the machine has them.
#pragma once

#include "support/io_support.h"

#include <cstdlib>
#include <locale>
#include <string>

namespace fabseq::test {

/// Locales of languages ("de_DE") with UTF-8, in a folder. They go at the end, and that of the start comes
/// back.
class OtherLocales {
 public:
  OtherLocales() { (void)::setenv("LOCPATH", directory_.path().c_str(), 1); }
  OtherLocales(const OtherLocales&) = delete;
  OtherLocales& operator=(const OtherLocales&) = delete;
  ~OtherLocales() {
    unset();
    (void)::unsetenv("LOCPATH");
  }

  /// Makes the locale, which takes two seconds, and returns whether that was possible.
  bool make(const std::string& language) const {
    const std::string command =
        "localedef -i " + language + " -f UTF-8 " + directory_.file(name(language)) + " >/dev/null 2>&1";
    return std::system(command.c_str()) == 0;
  }
  /// Makes one that has been made that of C and C++.
  void set(const std::string& language) const { std::locale::global(std::locale(name(language))); }
  void unset() const { std::locale::global(before_); }

 private:
  static std::string name(const std::string& language) { return language + ".UTF-8"; }

  ScratchDirectory directory_;
  std::locale before_;
};

}  // namespace fabseq::test
