// SPDX-License-Identifier: MIT
/// Numbers are read and written with a decimal point under locales that have something else: a comma and
/// points between thousands (de_DE), or characters of two bytes (ps_AF).
#include "fabseq/base/plain_numbers.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/json.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/stop.h"
#include "fabseq/config/command_line.h"
#include "fabseq/grid/index_box.h"
#include "fabseq/keys/config_key.h"
#include "fabseq/solve/solve_report.h"
#include "support/other_locale.h"
#include "support/refusal.h"
#include "tasks/gradient_check.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <utility>

namespace fabseq {
namespace {

/// The decimal point of the C library in this thread.
std::string decimal_point() {
  std::string text(8, '\0');
  text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.1f", 0.5)));
  return text.substr(1, text.size() - 2);
}

using Language = std::pair<const char*, const char*>;  // and its decimal point
constexpr Language languages[] = {{"de_DE", ","}, {"ps_AF", "\u066b"}};

/// Numbers follow the locale of the process, unless something sees to that: run_session() leaves the thread
/// of the tests with a decimal point.
class PlainNumbersTest : public testing::TestWithParam<Language> {
 protected:
  static void SetUpTestSuite() {
    locales = std::make_unique<test::OtherLocales>();
    are_made = true;
    for (const auto& [language, point] : languages) are_made = are_made && locales->make(language);
  }
  static void TearDownTestSuite() { locales.reset(); }

  void SetUp() override {
    if (!are_made) GTEST_SKIP() << "no locale can be made here: localedef, package locales (setup.sh --ci)";
    set_locale();
    (void)::uselocale(LC_GLOBAL_LOCALE);
    ASSERT_EQ(decimal_point(), GetParam().second);
  }
  void TearDown() override {
    (void)::uselocale(thread_);
    locales->unset();
  }
  static void set_locale() { locales->set(GetParam().first); }

  inline static std::unique_ptr<test::OtherLocales> locales;
  inline static bool are_made = false;

 private:
  locale_t thread_ = ::uselocale(nullptr);
};

TEST_P(PlainNumbersTest, OfTheCLibraryInThisThreadOnly) {
  {
    const PlainNumbers plain;
    EXPECT_EQ(decimal_point(), ".");
    EXPECT_EQ(std::strtod("0.25", nullptr), 0.25);
    std::string elsewhere;
    std::thread([&] { elsewhere = decimal_point(); }).join();
    EXPECT_EQ(elsewhere, GetParam().second);
    { const PlainNumbers inner; }
    EXPECT_EQ(decimal_point(), ".");
  }
  EXPECT_EQ(decimal_point(), GetParam().second);
}

TEST_P(PlainNumbersTest, LastThroughALocaleThatIsSetLater) {
  const PlainNumbers plain;
  locales->unset();
  set_locale();
  EXPECT_EQ(decimal_point(), ".");
}

TEST_P(PlainNumbersTest, AreReadFromTexts) {
  EXPECT_EQ(number_in<double>("0.25"), 0.25);
  EXPECT_EQ(number_in<double>("-inf"), -std::numeric_limits<double>::infinity());
  for (const char* text : {"", "0,25", "0.25 ", " 0.25", "0.25x", "1e999", "x"})
    EXPECT_EQ(number_in<double>(text), std::nullopt) << text;
  EXPECT_EQ(number_in<int>("1234"), 1234);
  EXPECT_EQ(number_in<int>("1.234"), std::nullopt);
  EXPECT_EQ(number_in<int>("3000000000"), std::nullopt);
  EXPECT_EQ(parse_duration("0.5"), 0.5);
  EXPECT_EQ(parse_duration("1:00:00.25"), 3600.25);
}

TEST_P(PlainNumbersTest, AreReadInRangesOfKeys) {
  const Interval range = Interval::parse("(-1.5, 0.25]");
  EXPECT_EQ(range.low, -1.5);
  EXPECT_EQ(range.high, 0.25);
  EXPECT_EQ(range.text(), " in (-1.5, 0.25]");
  EXPECT_TRUE(Interval::parse("").contains(1e300));
  EXPECT_EQ(Interval::parse("[1000.5, inf)").text(), " >= 1000.5");
}

TEST_P(PlainNumbersTest, AreReadAndWrittenInJson) {
  const std::string text = R"({"a":0.30000000000000004,"b":-1.5e-07,"c":1234567,"d":12345.75})";
  const Json value = parse_json(text, "test");
  EXPECT_EQ(value.at("a").get<double>(), 0.1 + 0.2);
  EXPECT_EQ(value.at("b").get<double>(), -1.5e-7);
  EXPECT_EQ(to_text(value), text);
  EXPECT_EQ(shown(Json(0.25)), "0.25");
  EXPECT_EQ(test::refusal([] { (void)parse_json("[0,25.5, 0.x]", "test"); }).find("test: line 1, column 1"),
            0);
}

TEST_P(PlainNumbersTest, AreWrittenInTexts) {
  EXPECT_EQ(formatted("%.3f %g %.2e %d %s", 1234567.25, 0.5, 1e-7, 1234567, "a,b"),
            "1234567.250 0.5 1.00e-07 1234567 a,b");
  EXPECT_EQ(formatted("%s", std::string(5000, 'x').c_str()), std::string(5000, 'x'));
  EXPECT_EQ(to_text<3>(Point<3>{0.5, -1.25, 12345.5}), "[0.5,-1.25,12345.5]");
  EXPECT_EQ(to_text<2>(Index<2>{12345, -1}), "[12345,-1]");
  const SolveReport report{12345, 0.5, false, "iteration limit"};
  EXPECT_EQ(test::error_text<NumericalError>([&] { require_convergence(report, "heat"); }),
            "heat did not converge: 12345 iterations, residual 0.5 (iteration limit)");
}

TEST_P(PlainNumbersTest, AreWrittenInTables) {
  GradientCheck check;
  check.steps = {0.1};
  GradientError error;
  error.name = "objective_0";
  error.type = "distortion";
  error.variables = "design";
  error.value = 12345.5;
  error.adjoint = 0.25;
  error.differences = {0.2501};
  error.relative = {1.0 / 3};
  check.errors = {error};
  EXPECT_EQ(check.csv(),
            "name,type,variables,value,adjoint,step,difference,relative_error\n"
            "objective_0,distortion,design,12345.5,0.25,0.1,0.2501,0.3333333333\n");
  EXPECT_NE(to_text(check.json()).find("\"differences\":[0.2501]"), std::string::npos);
}

TEST_P(PlainNumbersTest, AreReadInConfigsAndTheirHelp) {
  std::string help;
  ASSERT_NO_THROW(help = help_text());
  EXPECT_NE(help.find("a number in (-1, 0.5)"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Locales, PlainNumbersTest, testing::ValuesIn(languages));

}  // namespace
}  // namespace fabseq
