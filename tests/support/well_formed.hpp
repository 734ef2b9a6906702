#pragma once
// A small check that markup is well-formed XML: elements nest, attributes are quoted, only the five named entities and
// numeric ones, no raw '<' or '&' in text. Enough for pages that the project writes itself; no validator.

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw::test {

/// Empty when `markup` is well-formed, else what is wrong and where.
inline std::string first_markup_error(std::string_view markup) {
  const auto at = [&](std::size_t i) {
    return " at byte " + std::to_string(i) + ": " + std::string(markup.substr(i, 60));
  };
  const auto is_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == ':' || c == '_';
  };
  std::vector<std::string> open;
  std::size_t i = 0;
  const auto check_entity = [&](std::size_t where) {
    for (const char* entity : {"&amp;", "&lt;", "&gt;", "&quot;", "&#"}) {
      if (markup.substr(where).starts_with(entity)) return true;
    }
    return false;
  };
  while (i < markup.size()) {
    if (markup[i] == '&' && !check_entity(i)) return "unescaped &" + at(i);
    if (markup[i] != '<') {
      ++i;
      continue;
    }
    const std::size_t start = i++;
    if (i < markup.size() && markup[i] == '!') {
      i = markup.find('>', i);
      if (i == std::string_view::npos) return "open declaration" + at(start);
      ++i;
      continue;
    }
    const bool closing = i < markup.size() && markup[i] == '/';
    if (closing) ++i;
    const std::size_t name_start = i;
    while (i < markup.size() && is_name(markup[i])) ++i;
    const std::string name(markup.substr(name_start, i - name_start));
    if (name.empty()) return "unescaped <" + at(start);
    bool empty_element = false;
    while (i < markup.size() && markup[i] != '>') {
      if (markup[i] == '/') {
        empty_element = true;
        ++i;
      } else if (std::isspace(static_cast<unsigned char>(markup[i])) != 0) {
        ++i;
      } else {
        const std::size_t attribute = i;
        while (i < markup.size() && is_name(markup[i])) ++i;
        if (i == attribute || i + 1 >= markup.size() || markup[i] != '=' || markup[i + 1] != '"')
          return "bad attribute" + at(attribute);
        const std::size_t value = i + 2;
        i = markup.find('"', value);
        if (i == std::string_view::npos) return "open attribute" + at(attribute);
        if (markup.substr(value, i - value).find('<') != std::string_view::npos)
          return "< in attribute" + at(attribute);
        ++i;
      }
    }
    if (i >= markup.size()) return "open tag" + at(start);
    ++i;
    if (closing) {
      if (open.empty() || open.back() != name)
        return "</" + name + "> does not close <" + (open.empty() ? "" : open.back()) + ">" + at(start);
      open.pop_back();
    } else if (!empty_element) {
      open.push_back(name);
      if (name == "script") i = std::min(markup.find("</script>", i), markup.size());  // is no markup
    }
  }
  return open.empty() ? "" : "<" + open.back() + "> is never closed";
}

}  // namespace grainlaw::test
