#include "app/report/text.hpp"

#include <array>
#include <cctype>
#include <utility>

namespace grainlaw::app::report {
namespace {

using Style = TextRun::Style;

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

/// Length of the valid UTF-8 sequence at the start of `s`; 0 when there is none.
std::size_t utf8_length(std::string_view s) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(s[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || s.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  // Overlong forms, surrogates and what lies beyond U+10FFFF.
  if ((first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) > 0x9F)) return 0;
  if ((first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) > 0x8F)) return 0;
  return length;
}

/// XML 1.0 has no place for these, not even escaped.
bool is_forbidden_control(unsigned char c) { return (c < 0x20 && c != '\t' && c != '\n') || c == 0x7F; }

std::string sanitized(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::string_view unit = text.substr(0, length == 0 ? 1 : length);
    const bool noncharacter = unit == "\xEF\xBF\xBE" || unit == "\xEF\xBF\xBF";
    const bool bad = length == 0 || noncharacter || is_forbidden_control(static_cast<unsigned char>(unit[0]));
    out += bad ? kReplacement : unit;
    text.remove_prefix(unit.size());
  }
  return out;
}

std::string letter_of(std::string_view word) {
  using Letter = std::pair<std::string_view, std::string_view>;
  static constexpr std::array letters{Letter{"alpha", "α"}, Letter{"beta", "β"},   Letter{"gamma", "γ"},
                                      Letter{"delta", "δ"}, Letter{"lambda", "λ"}, Letter{"nu", "ν"},
                                      Letter{"phi", "φ"},   Letter{"sigma", "σ"},  Letter{"psi", "ψ"},
                                      Letter{"chi", "χ"},   Letter{"kappa", "κ"}};
  for (const auto& [name, letter] : letters) {
    if (word == name) return std::string(letter);
  }
  return std::string(word);
}

bool is_alphanumeric(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

}  // namespace

Text notation(std::string_view label) {
  Text text;
  std::string upright;
  const auto flush = [&] {
    if (!upright.empty()) text.runs.push_back({std::exchange(upright, {}), Style::upright});
  };
  std::size_t i = 0;
  while (i < label.size()) {
    const bool shifted = (label[i] == '_' || label[i] == '^') && i + 1 < label.size() && label[i + 1] == '{';
    const std::size_t open = shifted ? i + 1 : i;
    const std::size_t close = label[open] == '{' ? label.find('}', open) : std::string_view::npos;
    if (close == std::string_view::npos) {
      upright += label[i++];
      continue;
    }
    flush();
    const Style style = !shifted ? Style::italic : label[i] == '_' ? Style::subscript : Style::superscript;
    text.runs.push_back({std::string(label.substr(open + 1, close - open - 1)), style});
    i = close + 1;
  }
  flush();
  return text;
}

Text plain(std::string_view text) { return {{{sanitized(text), Style::upright}}}; }

Text paper_symbol(std::string_view ascii) {
  Text text;
  std::size_t i = 0;
  while (i < ascii.size()) {
    const std::size_t start = i;
    const bool subscript = ascii[i] == '_' && i > 0;
    if (subscript) ++i;
    const std::size_t word = i;
    while (i < ascii.size() && is_alphanumeric(ascii[i])) ++i;
    if (i == word) {
      text.runs.push_back({std::string(1, ascii[start]), Style::upright});
      i = start + 1;
    } else {
      text.runs.push_back({letter_of(ascii.substr(word, i - word)), subscript ? Style::subscript : Style::italic});
    }
  }
  return text;
}

Text operator+(Text left, const Text& right) {
  left.runs.insert(left.runs.end(), right.runs.begin(), right.runs.end());
  return left;
}

std::string escape_markup(std::string_view text) {
  static constexpr std::string_view characters = "&<>\"'";
  static constexpr std::array entities{"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    const std::size_t at = characters.find(c);
    if (at == std::string_view::npos) {
      out += c;
    } else {
      out += entities[at];
    }
  }
  return out;
}

std::string to_html(const Text& text) {
  std::string out;
  for (const TextRun& run : text.runs) {
    const std::string content = escape_markup(run.text);
    const std::string tag = run.style == Style::italic        ? "i"
                            : run.style == Style::subscript   ? "sub"
                            : run.style == Style::superscript ? "sup"
                                                              : "";
    out += tag.empty() ? content : "<" + tag + ">" + content + "</" + tag + ">";
  }
  return out;
}

std::string to_svg(const Text& text) {
  // Shifts by dy, which every renderer knows (baseline-shift is not drawn by all), and back on the next run.
  std::string out;
  double pending = 0;
  for (const TextRun& run : text.runs) {
    const std::string content = escape_markup(run.text);
    const bool shifted = run.style == Style::subscript || run.style == Style::superscript;
    const double shift = !shifted ? 0 : run.style == Style::subscript ? 3 : -5;
    const int dy = static_cast<int>(shift - pending);
    pending = shift;
    if (dy == 0 && run.style == Style::upright) {
      out += content;
      continue;
    }
    out += "<tspan";
    if (dy != 0) out += " dy=\"" + std::to_string(dy) + "\"";
    if (shifted) out += " font-size=\"75%\"";
    if (run.style == Style::italic) out += " font-style=\"italic\"";
    out += ">" + content + "</tspan>";
  }
  return out;
}

std::string to_plain(const Text& text) {
  std::string out;
  for (const TextRun& run : text.runs) {
    if (run.style == Style::subscript) out += '_';
    if (run.style == Style::superscript) out += '^';
    out += run.text;
  }
  return out;
}

std::size_t character_count(const Text& text) {
  std::size_t count = 0;
  for (const TextRun& run : text.runs) {
    for (const char c : run.text) count += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }
  return count;
}

}  // namespace grainlaw::app::report
