#include "model/files/schema.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "grainlaw_schemas.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/enum_names.hpp"
#include "model/vocabulary/error.hpp"
#include "model/vocabulary/nearest_word.hpp"

namespace grainlaw {
namespace {

/// Of a violation, outermost key first; array indices are decimal numbers. Empty: the document itself.
using Place = std::vector<std::string>;

constexpr std::size_t kMostViolations = 50;  // that are told of one document

/// By the schema library. The violation deepest in the document comes first, then what it makes of the objects around it, then
/// others; not more than kMostViolations.
std::vector<Place> violations_by_library(const Json& document, const valijson::Schema& schema) {
  valijson::ValidationResults results;
  if (valijson::Validator().validate(schema, valijson::adapters::NlohmannJsonAdapter(document), &results)) return {};
  std::vector<Place> places;
  valijson::ValidationResults::Error error;
  while (results.popError(error)) {
    Place place;
    for (std::size_t i = 1; i < error.context.size(); ++i) {  // the first element is "<root>"
      const std::string& part = error.context[i];             // "[key]"
      place.push_back(part.size() >= 2 && part.front() == '[' ? part.substr(1, part.size() - 2) : part);
    }
    if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
    if (places.size() == kMostViolations) break;
  }
  if (places.empty()) places.emplace_back();
  return places;
}

Json parsed(const std::string& file) {
  for (const auto& [name, text] : schemas::kFiles) {
    if (file == name) return Json::parse(text);
  }
  throw Error(fmt::format("schema {} was not built in", file));
}

/// Replaces {"$ref": "FILE#/POINTER"}, FILE empty for the document itself.
Json resolved(const Json& node, const std::string& file) {
  if (node.is_object() && node.contains("$ref")) {
    const std::string reference = node["$ref"];
    const auto hash = reference.find('#');
    const std::string target = hash == 0 ? file : reference.substr(0, hash);
    return resolved(parsed(target).at(Json::json_pointer(reference.substr(hash + 1))), target);
  }
  if (!node.is_structured()) return node;
  Json copy = node;
  for (auto& child : copy) child = resolved(child, file);
  return copy;
}

Json load(const std::string& file) {
  Json whole = resolved(parsed(file), file);
  whole.erase("definitions");
  return whole;
}

std::string range_text(const Json& s) {
  std::string text;
  const auto add = [&](const char* key, const char* relation) {
    if (s.contains(key)) text += fmt::format("{}{} {}", text.empty() ? " " : " and ", relation, s[key].dump());
  };
  add("minimum", ">=");
  add("exclusiveMinimum", ">");
  add("maximum", "<=");
  add("exclusiveMaximum", "<");
  return text;
}

/// "an integer >= 1 and <= 10000000", from the schema's own constraints.
std::string expected_text(const Json& s) {
  if (s.contains("enum")) {
    std::string text;
    for (const Json& choice : s["enum"]) text += fmt::format("{}{}", text.empty() ? "" : " or ", choice.dump());
    return text;
  }
  const std::string type = s.contains("type") && s["type"].is_string() ? s["type"].get<std::string>() : "";
  if (type == "integer") return fmt::format("an integer{}", range_text(s));
  if (type == "number") return fmt::format("a number{}", range_text(s));
  if (type == "boolean") return "true or false";
  if (type == "array") {
    const auto most = s.value("maxItems", Json::number_unsigned_t{0}),
               least = s.value("minItems", Json::number_unsigned_t{0});
    const std::string count = most == 0       ? fmt::format("at least {}", least)
                              : least == most ? fmt::format("{}", least)
                                              : fmt::format("{} to {}", least, most);
    return fmt::format("an array of {}{} elements", count, s.value("uniqueItems", false) ? " different" : "");
  }
  if (type == "string") {
    const bool excludes = s.value("pattern", "").starts_with("^[^");
    return s.contains("maxLength") ? fmt::format("a text of at most {} characters{}", s["maxLength"].dump(),
                                                 excludes ? " without control characters" : "")
                                   : "a text";
  }
  return type == "object" ? "an object" : "";
}

/// Keys of `value` that the schema does not know and those that it misses, with remedies.
std::vector<std::string> wrong_keys(const Json& value, const Json& s) {
  std::vector<std::string> texts;
  if (!value.is_object() || !s.contains("properties")) return texts;
  std::vector<std::string> known;
  for (const auto& property : s["properties"].items()) {
    if (!property.key().starts_with('$')) known.push_back(property.key());
  }
  for (const auto& item : value.items()) {
    if (s["properties"].contains(item.key()) || s.value("additionalProperties", Json(true)) != Json(false)) continue;
    const std::string nearest = nearest_word(item.key(), known);
    texts.push_back(fmt::format("unknown key '{}'; {}", one_line(item.key(), 60),
                                nearest.empty() ? fmt::format("known keys: {}", fmt::join(known, ", "))
                                                : fmt::format("did you mean '{}'?", nearest)));
    if (texts.size() == kMostViolations) break;
  }
  for (const Json& key : s.value("required", Json::array())) {
    if (value.contains(key.get<std::string>())) continue;
    const Json& wanted = s["properties"][key.get<std::string>()];
    texts.push_back(fmt::format("misses the key '{}'; give {}", key.get<std::string>(),
                                wanted.value("description", expected_text(wanted))));
  }
  return texts;
}

/// What a value is that the schema does not allow, and what it should be.
std::string wrong_value(const Json& value, const Json& s) {
  std::string got = one_line(value.is_structured() && value.size() > 8
                                 ? fmt::format("{} of {} elements", value.type_name(), value.size())
                                 : value.dump(-1, ' ', false, Json::error_handler_t::replace),
                             60);
  const std::string expected = expected_text(s), description = s.value("description", "");
  const std::string remedy = expected.empty()      ? description
                             : description.empty() ? expected
                                                   : fmt::format("{} ({})", expected, description);
  return fmt::format("got {}; give {}", got, remedy);
}

bool all_different(const Json& array) {
  std::set<std::string> seen;
  return std::ranges::all_of(array, [&](const Json& element) {
    return seen.insert(element.dump(-1, ' ', false, Json::error_handler_t::replace)).second;
  });
}

/// Length and uniqueness of arrays. The library compares and reports every pair of elements: too slow for hostile
/// input.
std::optional<Place> first_array_violation(const Json& value, const Json& s) {
  if (value.is_array() && s.contains("items")) {
    if (value.size() > s.value("maxItems", std::size_t{1000000})) return Place{};
    if (s.value("uniqueItems", false) && !all_different(value)) return Place{};
  }
  if (!value.is_structured()) return std::nullopt;
  for (const auto& item : value.items()) {
    const Json* next = nullptr;
    if (value.is_array() && s.contains("items")) next = &s["items"];
    if (value.is_object() && s.contains("properties") && s["properties"].contains(item.key()))
      next = &s["properties"][item.key()];
    if (next == nullptr) continue;
    std::optional<Place> violation = first_array_violation(item.value(), *next);
    if (!violation) continue;
    violation->insert(violation->begin(), item.key());
    return violation;
  }
  return std::nullopt;
}

Json without_unique_items(Json node) {
  if (node.is_object()) node.erase("uniqueItems");
  if (node.is_structured()) {
    for (auto& child : node) child = without_unique_items(child);
  }
  return node;
}

const std::map<Schema, Json>& schemas_built_in() {
  static const std::map<Schema, Json> all = [] {
    std::map<Schema, Json> whole;
    for (const Schema which : kValues<Schema>) whole[which] = load(std::string(to_string(which)) + ".schema.json");
    return whole;
  }();
  return all;
}

/// As the schema library takes it, made once: to make it takes longer than to judge by it.
const valijson::Schema& for_library(Schema which) {
  static std::mutex guard;
  static std::map<Schema, valijson::Schema> all;
  const std::lock_guard<std::mutex> lock(guard);
  const auto [made, fresh] = all.try_emplace(which);
  if (fresh) {
    const Json text = without_unique_items(schema(which));
    valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(text), made->second);
  }
  return made->second;
}

/// "NAME: KEY: got ...; give ...", one for each wrong key there; where there is none, for the value itself unless what is
/// wrong with it lies `within`.
std::vector<std::string> violation_texts(const Json& document, Schema which, const std::string& name,
                                         const Place& violation, bool within) {
  const Json* value = &document;
  const Json* s = &schema(which);
  std::string place;
  for (const std::string& part : violation) {
    // A schema without a subschema for this part (anyOf) describes the part itself.
    const Json* next = nullptr;
    if (value->is_array() && s->contains("items")) {
      next = &(*s)["items"];
    } else if (value->is_object() && s->contains("properties") && (*s)["properties"].contains(part)) {
      next = &(*s)["properties"][part];
    } else if (value->is_object() && s->value("additionalProperties", Json(true)).is_object()) {
      next = &(*s)["additionalProperties"];
    }
    if (next == nullptr) break;
    if (value->is_array()) {
      value = &value->at(std::stoul(part));
      place += fmt::format("[{}]", part);
    } else {
      value = &value->at(part);
      place += fmt::format("{}{}", place.empty() ? "" : ".", one_line(part, 60));
    }
    s = next;
  }
  std::vector<std::string> texts = wrong_keys(*value, *s);
  if (texts.empty() && !within) texts.push_back(wrong_value(*value, *s));
  for (std::string& text : texts) text = fmt::format("{}: {}{}", name, place.empty() ? "" : place + ": ", text);
  return texts;
}

}  // namespace

const Json& schema(Schema which) { return schemas_built_in().at(which); }

std::vector<std::string> schema_violations(const Json& document, Schema which, const std::string& name) {
  std::vector<Place> places;
  if (const auto of_array = first_array_violation(document, schema(which)))
    places = {*of_array};
  else
    places = violations_by_library(document, for_library(which));
  std::vector<std::string> all;
  for (auto place = places.begin(); place != places.end(); ++place) {
    const bool within = std::any_of(places.begin(), place, [&](const Place& inner) {
      return inner.size() >= place->size() && std::equal(place->begin(), place->end(), inner.begin());
    });
    for (std::string& text : violation_texts(document, which, name, *place, within)) {
      if (std::find(all.begin(), all.end(), text) == all.end()) all.push_back(std::move(text));
    }
  }
  return all;
}

void check_schema(const Json& document, Schema which, const std::string& name) {
  const std::vector<std::string> violations = schema_violations(document, which, name);
  if (!violations.empty()) throw InvalidInput(violations.front());
}

}  // namespace grainlaw
