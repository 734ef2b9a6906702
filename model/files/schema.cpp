#include "model/files/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "grainlaw_schemas.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

/// Place of the first violation, outermost key first; array indices are decimal numbers. Empty place: the document
/// itself.
struct Violation {
  bool found = false;
  std::vector<std::string> place;
};

/// By the schema library; `schema` must be free of references. The violation deepest in the document comes first.
Violation first_violation(const Json& document, const Json& schema) {
  valijson::Schema compiled;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(schema), compiled);
  valijson::ValidationResults results;
  if (valijson::Validator().validate(compiled, valijson::adapters::NlohmannJsonAdapter(document), &results)) return {};
  Violation violation{true, {}};
  valijson::ValidationResults::Error error;
  if (!results.popError(error)) return violation;
  for (std::size_t i = 1; i < error.context.size(); ++i) {  // the first element is "<root>"
    const std::string& part = error.context[i];             // "[key]"
    violation.place.push_back(part.size() >= 2 && part.front() == '[' ? part.substr(1, part.size() - 2) : part);
  }
  return violation;
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
  if (type == "string")
    return s.contains("maxLength") ? fmt::format("a text of at most {} characters", s["maxLength"].dump()) : "a text";
  return type == "object" ? "an object" : "";
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
    }
  }
  return row[b.size()];
}

/// The first key of `value` that the schema does not know, with a remedy; empty when all are known.
std::string unknown_key(const Json& value, const Json& s) {
  if (!value.is_object() || !s.contains("properties") || s.value("additionalProperties", Json(true)) != Json(false))
    return "";
  for (const auto& item : value.items()) {
    if (s["properties"].contains(item.key())) continue;
    std::string nearest, all;
    for (const auto& known : s["properties"].items()) {
      all += fmt::format("{}{}", all.empty() ? "" : ", ", known.key());
      const std::size_t distance = item.key().size() > 64 ? 65 : edit_distance(item.key(), known.key());
      if (distance <= 2 && (nearest.empty() || distance < edit_distance(item.key(), nearest))) nearest = known.key();
    }
    const std::string remedy =
        nearest.empty() ? fmt::format("known keys: {}", all) : fmt::format("did you mean '{}'?", nearest);
    return fmt::format("unknown key '{}'; {}", one_line(item.key(), 60), remedy);
  }
  return "";
}

std::string missing_key(const Json& value, const Json& s) {
  if (!value.is_object() || !s.contains("required")) return "";
  for (const Json& key : s["required"]) {
    if (value.contains(key.get<std::string>())) continue;
    const Json& wanted = s["properties"][key.get<std::string>()];
    return fmt::format("misses the key '{}'; give {}", key.get<std::string>(),
                       wanted.value("description", expected_text(wanted)));
  }
  return "";
}

std::string complaint(const Json& value, const Json& s) {
  for (const auto& text : {unknown_key(value, s), missing_key(value, s)}) {
    if (!text.empty()) return text;
  }
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
  return std::all_of(array.begin(), array.end(), [&](const Json& element) {
    return seen.insert(element.dump(-1, ' ', false, Json::error_handler_t::replace)).second;
  });
}

/// Length and uniqueness of arrays. The library compares and reports every pair of elements: too slow for hostile
/// input.
Violation first_array_violation(const Json& value, const Json& s) {
  if (value.is_array() && s.contains("items")) {
    if (value.size() > s.value("maxItems", std::size_t{1000000})) return {true, {}};
    if (s.value("uniqueItems", false) && !all_different(value)) return {true, {}};
  }
  if (!value.is_structured()) return {};
  for (const auto& item : value.items()) {
    const Json* next = nullptr;
    if (value.is_array() && s.contains("items")) next = &s["items"];
    if (value.is_object() && s.contains("properties") && s["properties"].contains(item.key()))
      next = &s["properties"][item.key()];
    if (next == nullptr) continue;
    Violation violation = first_array_violation(item.value(), *next);
    if (!violation.found) continue;
    violation.place.insert(violation.place.begin(), item.key());
    return violation;
  }
  return {};
}

Json without_unique_items(Json node) {
  if (node.is_object()) node.erase("uniqueItems");
  if (node.is_structured()) {
    for (auto& child : node) child = without_unique_items(child);
  }
  return node;
}

struct Schemas {
  std::map<Schema, Json> whole, for_library;

  Schemas() {
    for (const auto& [which, file] : {std::pair{Schema::spec, "spec.schema.json"},
                                      {Schema::path, "path.schema.json"},
                                      {Schema::test, "test.schema.json"},
                                      {Schema::dataset, "dataset.schema.json"},
                                      {Schema::parameters, "parameters.schema.json"},
                                      {Schema::study, "study.schema.json"},
                                      {Schema::study_settings, "study_settings.schema.json"},
                                      {Schema::plan, "plan.schema.json"}}) {
      whole[which] = load(file);
      for_library[which] = without_unique_items(whole[which]);
    }
  }
};

const Schemas& schemas_built_in() {
  static const Schemas all;
  return all;
}

}  // namespace

const Json& schema(Schema which) { return schemas_built_in().whole.at(which); }

void check_schema(const Json& document, Schema which, const std::string& name) {
  Violation violation = first_array_violation(document, schema(which));
  if (!violation.found) violation = first_violation(document, schemas_built_in().for_library.at(which));
  if (!violation.found) return;
  const Json* value = &document;
  const Json* s = &schema(which);
  std::string place;
  for (const std::string& part : violation.place) {
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
  throw InvalidInput(fmt::format("{}: {}{}", name, place.empty() ? "" : place + ": ", complaint(*value, *s)));
}

}  // namespace grainlaw
