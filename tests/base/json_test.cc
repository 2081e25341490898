// SPDX-License-Identifier: MIT
#include "fabseq/base/json.h"

#include <gtest/gtest.h>

#include "support/refusal.h"
#include <cmath>
#include <limits>
#include <random>

namespace fabseq {
namespace {

std::string parse_error(const std::string& text) {
  return test::refusal([&] { (void)Json::parse(text, "file.json"); });
}

TEST(JsonTest, ParsesEveryKindOfValueAndKeepsTheOrder) {
  const Json value = Json::parse(R"({"z": 1, "a": [true, null, -2.5, "x\n\u00e9"], "m": {}})", "test");
  ASSERT_TRUE(value.is_object());
  EXPECT_EQ(value.members()[0].first, "z");
  EXPECT_EQ(value.members()[1].first, "a");
  EXPECT_EQ(value.members()[2].first, "m");
  EXPECT_TRUE(value.at("z").is_integer());
  EXPECT_EQ(value.at("z").integer(), 1);
  const Json::Array& items = value.at("a").items();
  ASSERT_EQ(items.size(), 4U);
  EXPECT_TRUE(items[0].boolean());
  EXPECT_TRUE(items[1].is_null());
  EXPECT_FALSE(items[2].is_integer());
  EXPECT_EQ(items[2].number(), -2.5);
  EXPECT_EQ(items[3].string(), "x\n\xc3\xa9");
  EXPECT_TRUE(value.at("m").is_object());
  EXPECT_EQ(value.dump(), "{\"z\":1,\"a\":[true,null,-2.5,\"x\\n\xc3\xa9\"],\"m\":{}}");
}

TEST(JsonTest, AllowsComments) {
  const Json value = Json::parse("// first\n{\"a\": /* inside */ 1 // last\n}", "test");
  EXPECT_EQ(value.at("a").integer(), 1);
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
    EXPECT_EQ(Json::parse(Json(value).dump(), "test").number(), value);
  }
  for (const double value : {0.1, 1.0, 1e-9, 5e-324, std::numeric_limits<double>::max(), 1.0 / 3.0}) {
    const Json again = Json::parse(Json(value).dump(), "test");
    EXPECT_EQ(again.number(), value);
    EXPECT_FALSE(again.is_integer()) << Json(value).dump();
  }
  EXPECT_TRUE(std::signbit(Json::parse(Json(-0.0).dump(), "test").number()));
  const std::int64_t large = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(Json::parse(Json(large).dump(), "test").integer(), large);
  EXPECT_EQ(Json::parse("18446744073709551615", "test").number(), 18446744073709551615.0);
}

TEST(JsonTest, NonFiniteNumbersBecomeNull) {
  EXPECT_EQ(Json(std::vector<double>{std::nan(""), 1.5, HUGE_VAL}).dump(), "[null,1.5,null]");
}

TEST(JsonTest, IndentsObjectsAndKeepsVectorsOnALine) {
  const Json value =
      Json::object({{"a", std::vector<int>{1, 2}}, {"b", Json::object({{"c", "x"}})}, {"d", Json::array()}});
  EXPECT_EQ(value.dump(2), "{\n  \"a\": [1, 2],\n  \"b\": {\n    \"c\": \"x\"\n  },\n  \"d\": []\n}");
  EXPECT_EQ(Json::parse(value.dump(2), "test").dump(), value.dump());
}

TEST(JsonTest, InvalidUtf8IsReplacedNotThrown) { EXPECT_EQ(Json("a\xff").dump(), "\"a\xef\xbf\xbd\""); }

TEST(JsonTest, SetsFindsAndAppends) {
  Json value;
  value.set("a", 1);
  value.set("list", Json()).append(2.5);
  value.set("a", "new");
  EXPECT_EQ(value.dump(), R"({"a":"new","list":[2.5]})");
  EXPECT_EQ(value.find("none"), nullptr);
  EXPECT_EQ(Json(3).find("a"), nullptr);
  EXPECT_THROW((void)value.at("none"), std::out_of_range);
  EXPECT_THROW((void)value.at("a").number(), std::bad_variant_access);
  EXPECT_EQ(Json::parse("[1, 2.5]", "test").numbers(), (std::vector<double>{1.0, 2.5}));
}

}  // namespace
}  // namespace fabseq
