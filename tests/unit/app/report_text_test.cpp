#include "app/report/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "app/report/number_text.hpp"

namespace grainlaw::app::report {
namespace {

TEST(ReportText, MarkupIsEscaped) {
  const std::string hostile = R"(<script>alert("x")</script>&'><img onerror=1>)";
  const std::string escaped = escape_markup(hostile);
  EXPECT_EQ(escaped.find_first_of("<>\"'"), std::string::npos);
  EXPECT_EQ(to_html(plain(hostile)), escaped);
  EXPECT_EQ(to_svg(plain(hostile)), escaped);
}

TEST(ReportText, PlainTextHasNoNotation) { EXPECT_EQ(to_html(plain("a_{b}^{c}{d}")), "a_{b}^{c}{d}"); }

TEST(ReportText, BadBytesBecomeReplacementCharacters) {
  const std::string replacement = "\xEF\xBF\xBD";
  EXPECT_EQ(to_html(plain(std::string("a\0b", 3))), "a" + replacement + "b");
  EXPECT_EQ(to_html(plain("\x1b[31m")), replacement + "[31m");
  EXPECT_EQ(to_html(plain("\xC3")), replacement);                                      // cut off
  EXPECT_EQ(to_html(plain("\xC0\xAF")), replacement + replacement);                    // overlong
  EXPECT_EQ(to_html(plain("\xED\xA0\x80")), replacement + replacement + replacement);  // surrogate
  EXPECT_EQ(to_html(plain("ν → ⟨r⟩ 😀")), "ν → ⟨r⟩ 😀");
}

TEST(ReportText, NotationKnowsItalicAndShifts) {
  const Text text = notation("{s}_{max}^{2} [–] {open");
  EXPECT_EQ(to_html(text), "<i>s</i><sub>max</sub><sup>2</sup> [–] {open");
  EXPECT_EQ(to_plain(text), "s_max^2 [–] {open");
}

TEST(ReportText, SvgReturnsToTheBaseline) {
  EXPECT_EQ(to_svg(notation("a_{b}c")), "a<tspan dy=\"3\" font-size=\"75%\">b</tspan><tspan dy=\"-3\">c</tspan>");
}

TEST(ReportText, PaperSymbols) {
  EXPECT_EQ(to_html(paper_symbol("nu_c")), "<i>ν</i><sub>c</sub>");
  EXPECT_EQ(to_html(paper_symbol("beta_F: Q_max")), "<i>β</i><sub>F</sub>: <i>Q</i><sub>max</sub>");
  EXPECT_EQ(to_html(paper_symbol("a<b")), "<i>a</i>&lt;<i>b</i>");
}

TEST(ReportText, CharactersAreCountedNotBytes) { EXPECT_EQ(character_count(notation("{ν} = 0.7")), 7U); }

TEST(ReportNumbers, ErrorsHaveTwoDigitsAndValuesTheSameDecimals) {
  EXPECT_EQ(with_error(8.2719, 0.3149), "8.27 ± 0.31");
  EXPECT_EQ(with_error(0.0417249, 0.00021), "0.04172 ± 0.00021");
  EXPECT_EQ(with_error(5432.1, 120), "5432 ± 120");
  EXPECT_EQ(with_error(-1.5, 0.1), "\u22121.50 ± 0.10");
  EXPECT_EQ(with_error(0.6653, std::nan("")), "0.6653");
  EXPECT_EQ(with_error(0.6653, 0), "0.6653");
  EXPECT_EQ(interval_text(8.2719, 0.3149), "7.96 … 8.59");
  EXPECT_EQ(interval_text(0.0417249, 0.00021), "0.04151 … 0.04193");
  EXPECT_EQ(interval_text(5432.1, 120), "5312 … 5552");
  EXPECT_EQ(interval_text(0.6653, std::nan("")), "");
}

TEST(ReportNumbers, NothingUndefinedIsPrinted) {
  for (const double value :
       {std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(significant(value), kNoNumber);
    EXPECT_EQ(significant_padded(value), kNoNumber);
    EXPECT_EQ(fixed(value, 2), kNoNumber);
    EXPECT_EQ(with_error(value, 1), kNoNumber);
    EXPECT_EQ(percent_difference(value, 1), kNoNumber);
    EXPECT_EQ(duration(value), kNoNumber);
  }
  EXPECT_EQ(percent_difference(1, 0), kNoNumber);
  EXPECT_EQ(percent_difference(0, 0), kNoNumber);
}

TEST(ReportNumbers, DigitsAndSigns) {
  EXPECT_EQ(significant_padded(9.28), "9.280");
  EXPECT_EQ(significant_padded(5703, 4), "5703");
  EXPECT_EQ(fixed(-0.0001, 2), "0.00");
  EXPECT_EQ(percent_difference(0.98, 1), "\u22122.0\u00a0%");
  EXPECT_EQ(percent_difference(1, 1), "0\u00a0%");
  EXPECT_EQ(duration(45), "45 s");
  EXPECT_EQ(duration(600), "10.0 min");
  EXPECT_EQ(duration(7200), "2.0 h");
}

}  // namespace
}  // namespace grainlaw::app::report
