#pragma once
// Numbers in somebody else's text, independently of the locale.

#include <charconv>
#include <optional>
#include <string_view>

namespace grainlaw {

/// The whole text as a number; nothing when it is none, has a sign '+', blanks or more behind it, or is out of range.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// As number_of<double>; may begin with '+', as other programs write it.
inline std::optional<double> decimal(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  return number_of<double>(text.substr(plus ? 1 : 0));
}

/// Without blanks and tabs at its ends.
inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const auto begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

}  // namespace grainlaw
