// SPDX-License-Identifier: MIT
#include "fabseq/base/json.h"

#include "support/refusal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace fabseq {
namespace {

std::string parse_error(const std::string& text) {
  return test::refusal([&] { (void)parse_json(text, "file.json"); });
}

TEST(JsonTest, ParsesEveryKindOfValueAndKeepsTheOrder) {
  const Json value = parse_json(R"({"z": 1, "a": [true, null, -2.5, "x\n\u00e9"], "m": {}})", "test");
  ASSERT_TRUE(value.is_object());
  EXPECT_EQ(std::next(value.begin(), 0).key(), "z");
  EXPECT_EQ(std::next(value.begin(), 1).key(), "a");
  EXPECT_EQ(std::next(value.begin(), 2).key(), "m");
  EXPECT_TRUE(value.at("z").is_number_integer());
  EXPECT_EQ(value.at("z").get<std::int64_t>(), 1);
  const Json& items = value.at("a");
  ASSERT_EQ(items.size(), 4U);
  EXPECT_TRUE(items[0].get<bool>());
  EXPECT_TRUE(items[1].is_null());
  EXPECT_FALSE(items[2].is_number_integer());
  EXPECT_EQ(items[2].get<double>(), -2.5);
  EXPECT_EQ(items[3].get<std::string>(), "x\n\xc3\xa9");
  EXPECT_TRUE(value.at("m").is_object());
  EXPECT_EQ(to_text(value), "{\"z\":1,\"a\":[true,null,-2.5,\"x\\n\xc3\xa9\"],\"m\":{}}");
}

TEST(JsonTest, AllowsComments) {
  const Json value = parse_json("// first\n{\"a\": /* inside */ 1 // last\n}", "test");
  EXPECT_EQ(value.at("a").get<std::int64_t>(), 1);
}

TEST(JsonTest, TellsWhereTextIsMalformed) {
  EXPECT_EQ(parse_error("{\n  \"a\": 1,\n  \"b\" 2\n}").rfind("file.json: line 3, column 7: ", 0), 0U)
      << parse_error("{\n  \"a\": 1,\n  \"b\" 2\n}");
  EXPECT_EQ(parse_error("[1, 2").rfind("file.json: line 1, column 6: ", 0), 0U) << parse_error("[1, 2");
  EXPECT_EQ(parse_error("").rfind("file.json: line 1, column 1: ", 0), 0U) << parse_error("");
  for (const char* text : {"{\"a\": NaN}", "{} {}", "[1,]", "1e999", "\"\xff\"", "[\"a\nb\"]"}) {
    EXPECT_EQ(parse_error(text).rfind("file.json: line 1, column ", 0), 0U) << parse_error(text);
    EXPECT_EQ(parse_error(text).find('\n'), std::string::npos) << parse_error(text);
  }
}

TEST(JsonTest, ShowsMalformedTextAsUtf8) {
  const std::string error = parse_error("[1.\xef\xbb\xbf]");
  EXPECT_NE(error.find("'1.\xef\xbf\xbd'"), std::string::npos) << error;
}

TEST(JsonTest, RefusesKeysGivenTwiceAndBottomlessNesting) {
  EXPECT_EQ(parse_error(R"({"a": {"b": 1, "b": 2}})"),
            "file.json: key \"b\" is given twice in the same object");
  EXPECT_EQ(parse_error(R"({"a": {"b": 1}, "c": {"b": 2}})"), "no error");
  EXPECT_EQ(parse_error(std::string(100000, '[')), "file.json: nested more than 64 levels deep");
}

TEST(JsonTest, NumbersSurviveARoundTripBitForBit) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-300.0, 300.0), mantissa(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double value = mantissa(random) * std::pow(10.0, exponent(random));
    EXPECT_EQ(parse_json(to_text(value), "test").get<double>(), value);
  }
  for (const double value : {0.1, 1.0, 1e-9, 5e-324, std::numeric_limits<double>::max(), 1.0 / 3.0}) {
    const Json again = parse_json(to_text(value), "test");
    EXPECT_EQ(again.get<double>(), value);
    EXPECT_FALSE(again.is_number_integer()) << to_text(value);
  }
  EXPECT_TRUE(std::signbit(parse_json(to_text(-0.0), "test").get<double>()));
  const std::int64_t large = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(parse_json(to_text(large), "test").get<std::int64_t>(), large);
  EXPECT_EQ(parse_json("18446744073709551615", "test").get<double>(), 18446744073709551615.0);
}

TEST(JsonTest, NonFiniteNumbersBecomeNull) {
  EXPECT_EQ(to_text(std::vector<double>{std::nan(""), 1.5, HUGE_VAL}), "[null,1.5,null]");
}

TEST(JsonTest, IndentsObjectsAndKeepsVectorsOnALine) {
  const Json value =
      Json::object({{"a", std::vector<int>{1, 2}}, {"b", Json::object({{"c", "x"}})}, {"d", Json::array()}});
  EXPECT_EQ(to_text(value, 2), "{\n  \"a\": [1, 2],\n  \"b\": {\n    \"c\": \"x\"\n  },\n  \"d\": []\n}");
  EXPECT_EQ(to_text(parse_json(to_text(value, 2), "test")), to_text(value));
}

TEST(JsonTest, InvalidUtf8IsReplacedNotThrown) { EXPECT_EQ(to_text("a\xff"), "\"a\xef\xbf\xbd\""); }

TEST(JsonTest, FindsMembersOfObjects) {
  const Json value = {{"a", "new"}, {"list", {2.5}}};
  ASSERT_NE(find_member(value, "list"), nullptr);
  EXPECT_EQ(to_text(*find_member(value, "list")), "[2.5]");
  EXPECT_EQ(find_member(value, "none"), nullptr);
  EXPECT_EQ(find_member(Json(3), "a"), nullptr);
}

}  // namespace
}  // namespace fabseq
