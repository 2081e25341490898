// SPDX-License-Identifier: MIT
#include "fabseq/base/one_line.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

TEST(OneLineTest, TextsThatMayBePrinted) {
  for (const char* text : {"", "plain",
                           "Gr\xc3\xb6\xc3\x9f"
                           "e",
                           "\xe2\x82\xac \xf0\x9f\x94\xa5 \xef\xbf\xbd"})
    EXPECT_EQ(one_line(text), text);
}

TEST(OneLineTest, ControlCharacters) {
  EXPECT_EQ(one_line("a\nb\r\nc\td\x1b[31m"), "a b  c d [31m");
  EXPECT_EQ(one_line(std::string_view("a\0b\x7f", 4)), "a b ");
  EXPECT_EQ(one_line("a\xc2\x85"
                     "b\xe2\x80\xa8"
                     "c\xe2\x80\xa9"
                     "d"),
            "a b c d");
}

TEST(OneLineTest, BytesThatAreNoUtf8) {
  EXPECT_EQ(one_line("\xff\xfe"
                     "a\x80"),
            "??a?");
  EXPECT_EQ(one_line("\xc3"), "?");
  EXPECT_EQ(one_line("\xc3\x28"), "?(");
  EXPECT_EQ(one_line("\xe0\x80\x80|\xed\xa0\x80|\xf4\x90\x80\x80|\xc0\xaf"), "???|???|????|??");
}

}  // namespace
}  // namespace fabseq
