// SPDX-License-Identifier: MIT
/// What a section makes of members: declarations with type and default, and values read back.
#include "fabseq/keys/section.h"

#include "support/refusal.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

enum class Colour { red, green };

struct Inner {
  double depth = 0.25;
};
struct Other {
  int turns = 3;
};
struct Everything {
  bool flag = true;
  bool choice = false;
  int integer = 7;
  double number = 1e-9;
  std::string text = "t", nothing;
  Colour colour = Colour::green;
  int axis = -1;
  std::optional<double> optional;
  std::vector<double> vector;
  Inner inner;
  std::optional<Other> other;
};

Section<Everything> section() {
  using Its = Everything;
  Section<Its> keys("all", "All kinds");
  keys.key("flag", &Its::flag, "a flag")
      .key("choice", &Its::choice, "two words", {.words = "no yes"})
      .key("integer", &Its::integer, "an integer", {.range = "[1, 9]"})
      .key("number", &Its::number, "a number")
      .key("text", &Its::text, "a text")
      .key("nothing", &Its::nothing, "a text without default")
      .key("colour", &Its::colour, "an enumerator", {.words = "red green"})
      .key("axis", &Its::axis, "an axis", {.type = KeyType::axis})
      .key("optional", &Its::optional, "a number or a word", {.words = "auto"})
      .key("vector", &Its::vector, "numbers or a word", {.words = "none"})
      .section("inner", &Its::inner, "an object",
               Section<Inner>("all.inner", "Inner").key("depth", &Inner::depth, "its depth"),
               {.default_value = "{}"})
      .key("type", "what it is", {.type = KeyType::choice, .words = "this that"},
           [](Its& all, const Json& value, const KeyPlace& place) {
             if (value == "bad") refuse(place.pointer, shown(value), "this, that");
             if (value == "that") all.other.emplace();
           });
  keys.only_for("that").keys([](Its& all) -> Other& { return *all.other; },
                             Section<Other>("all").key("turns", &Other::turns, "only of that"));
  return keys;
}

TEST(SectionTest, DeclaresTypeAndDefaultOfMembers) {
  const std::vector<SectionKeys> declared = section().declarations();
  ASSERT_EQ(declared.size(), 2U);
  EXPECT_EQ(declared[1].path, "all.inner");
  EXPECT_EQ(declared[1].keys[0].default_value, "0.25");
  const std::vector<std::pair<KeyType, std::string>> expected = {
      {KeyType::flag, "true"},        {KeyType::choice, "\"no\""}, {KeyType::integer, "7"},
      {KeyType::number, "1e-9"},      {KeyType::text, "\"t\""},    {KeyType::text, ""},
      {KeyType::choice, "\"green\""}, {KeyType::axis, ""},         {KeyType::number, "\"auto\""},
      {KeyType::vector, "\"none\""},  {KeyType::section, "{}"},    {KeyType::choice, ""},
      {KeyType::integer, "3"}};
  ASSERT_EQ(declared[0].keys.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const ConfigKey& key = declared[0].keys[i];
    EXPECT_EQ(std::pair(key.type, key.default_value), expected[i]) << key.name;
    EXPECT_EQ(key.section, "all");
    EXPECT_EQ(key.variant, i + 1 == expected.size() ? "that" : "") << key.name;
  }
}

TEST(SectionTest, ReadsWhatAnObjectSays) {
  Everything all;
  section().read(all,
                 parse_json(R"({"flag": false, "choice": "yes", "integer": 2, "number": 0.5, "text": "u",
                    "colour": "red", "axis": "y", "optional": 4, "vector": [1, 2], "inner": {"depth": 3},
                    "type": "that", "turns": 5})",
                            "test"),
                 {"/all", 3});
  EXPECT_FALSE(all.flag);
  EXPECT_TRUE(all.choice);
  EXPECT_EQ(all.integer, 2);
  EXPECT_EQ(all.number, 0.5);
  EXPECT_EQ(all.text, "u");
  EXPECT_EQ(all.colour, Colour::red);
  EXPECT_EQ(all.axis, 1);
  EXPECT_EQ(all.optional, 4.0);
  EXPECT_EQ(all.vector, (std::vector<double>{1, 2}));
  EXPECT_EQ(all.inner.depth, 3.0);
  ASSERT_TRUE(all.other);
  EXPECT_EQ(all.other->turns, 5);
}

TEST(SectionTest, WordsStandForNoValueAndKeysOfOtherTypesAreLeftAlone) {
  Everything all;
  all.optional = 1.0;
  all.vector = {1.0};
  section().read(all, parse_json(R"({"optional": "auto", "vector": "none", "type": "this"})", "test"),
                 {"/all", 3});
  EXPECT_FALSE(all.optional);
  EXPECT_TRUE(all.vector.empty());
  EXPECT_FALSE(all.other);
  EXPECT_EQ(all.integer, 7);
}

TEST(SectionTest, ReadersKnowTheirPlace) {
  Everything all;
  EXPECT_EQ(test::refusal([&] {
              section().read(all, parse_json(R"({"type": "bad"})", "test"), {"/all", 3});
            }),
            "/all/type: found \"bad\"; allowed: this, that");
}

}  // namespace
}  // namespace fabseq
