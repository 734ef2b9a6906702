#pragma once
// Labels with symbols, as HTML, SVG or plain text. Own labels are written in a small notation,
//   {x} italic, _{x} subscript, ^{x} superscript, anything else literal (UTF-8),
// and whatever comes from a file enters through plain(), where nothing has a meaning.

#include <string>
#include <string_view>
#include <vector>

namespace grainlaw::app::report {

struct TextRun {
  enum class Style { upright, italic, subscript, superscript };
  std::string text;
  Style style = Style::upright;
};

struct Text {
  std::vector<TextRun> runs;
};

/// Text from the notation above; for labels in the source only.
Text notation(std::string_view label);

/// Text without any markup. Control characters and bytes that are no UTF-8 become U+FFFD.
Text plain(std::string_view text);

/// The paper's symbol from its ASCII spelling in the parameter table: "nu_c" -> {ν}_{c}, "s_max: Q_c" -> both parts.
Text paper_symbol(std::string_view ascii);

Text operator+(Text left, const Text& right);

/// `text` with & < > " ' replaced, safe as content and in a quoted attribute of HTML and XML.
std::string escape_markup(std::string_view text);

std::string to_html(const Text& text);
std::string to_svg(const Text& text);    ///< content of a <text> element
std::string to_plain(const Text& text);  ///< not escaped; for <title>, file-free descriptions and width estimates

/// Number of characters, not bytes.
std::size_t character_count(const Text& text);

}  // namespace grainlaw::app::report
