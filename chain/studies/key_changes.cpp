#include "chain/studies/key_changes.hpp"

#include <fmt/format.h>

#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

/// "tests[1].strain" as a JSON pointer: /tests/1/strain
Json::json_pointer pointer_to(const std::string& key) {
  std::string path = "/";
  for (const char c : key) {
    if (c == ']') continue;
    path += c == '.' || c == '[' ? '/' : c;
  }
  return Json::json_pointer(path);
}

bool has_place(const Json& document, const Json::json_pointer& place) {
  if (!document.contains(place.parent_pointer())) return false;
  return document.at(place.parent_pointer()).is_object();
}

}  // namespace

std::pair<std::string, Json> change_from(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0 || at + 1 == text.size())
    throw InvalidInput(fmt::format("'{}': is no change; give KEY=VALUE", one_line(text, 100)));
  const std::string value = text.substr(at + 1);
  const Json parsed = Json::parse(value, nullptr, false);
  return {text.substr(0, at), parsed.is_number() || parsed.is_array() ? parsed : Json(value)};
}

Changes changes_from(const std::vector<std::string>& texts) {
  Changes changes;
  for (const std::string& text : texts) changes.push_back(change_from(text));
  return changes;
}

Json changed(Json document, const Changes& changes, const std::string& name) {
  for (const auto& [key, value] : changes) {
    try {
      const Json::json_pointer place = pointer_to(key);
      if (!has_place(document, place)) throw InvalidInput("");
      document[place] = value;
    } catch (const std::exception&) {
      throw InvalidInput(
          fmt::format("{}: {}: there is no such place to change; name a key, or one of an entry that is "
                      "there, e.g. tests[1].strain",
                      one_line(name, 100), one_line(key, 100)));
    }
  }
  return document;
}

}  // namespace grainlaw::chain
