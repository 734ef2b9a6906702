// docs/formats.md against the tables in code. Run with GRAINLAW_UPDATE_DOCS=1 to rewrite the generated parts.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "app/exit_code.hpp"
#include "chain/planning/precision_plan.hpp"
#include "dem/runs/spec_file.hpp"
#include "model/calibrated_law.hpp"
#include "model/files/column.hpp"
#include "model/files/schema.hpp"
#include "model/vocabulary/probe_row.hpp"
#include "predict/prediction_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::app {
namespace {

const std::filesystem::path kDocument = std::filesystem::path(GRAINLAW_SOURCE_DIR) / "docs" / "formats.md";

std::string read_all(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What stands between "<!-- begin NAME -->" and "<!-- end NAME -->" must be `expected`.
void expect_section(const std::string& name, const std::string& expected) {
  std::string text = read_all(kDocument);
  const std::string begin = "<!-- begin " + name + " -->\n", end = "<!-- end " + name + " -->";
  const auto from = text.find(begin), to = text.find(end);
  ASSERT_NE(from, std::string::npos) << begin;
  ASSERT_NE(to, std::string::npos) << end;
  const auto start = from + begin.size();
  if (std::getenv("GRAINLAW_UPDATE_DOCS")) {
    text.replace(start, to - start, expected);
    std::ofstream(kDocument, std::ios::binary) << text;
    return;
  }
  EXPECT_EQ(text.substr(start, to - start), expected) << "run this test with GRAINLAW_UPDATE_DOCS=1";
}

/// Text that is safe in a cell of a Markdown table.
std::string cell(std::string text) {
  for (std::size_t i = 0; (i = text.find_first_of("|<*", i)) != std::string::npos; i += 2) text.insert(i, 1, '\\');
  return text;
}

TEST(FormatsDocument, ListsTheParameters) {
  std::string table = "| key | symbol | Eq. | meaning | bounds | published |\n|---|---|---|---|---|---|\n";
  for (const ParameterInfo& p : parameter_table()) {
    table += fmt::format("| `{}` | {} | {} | {} | {} … {} | {} |\n", p.name, cell(p.symbol), cell(p.equation),
                         cell(p.meaning), p.lower, p.upper, p.published ? fmt::format("{}", *p.published) : "–");
  }
  expect_section("parameters", table);
}

template <class Row>
std::string column_table(const std::vector<Column<Row>>& columns) {
  std::string table = "| column | symbol | meaning | needed |\n|---|---|---|---|\n";
  for (const auto& c : columns) {
    table +=
        fmt::format("| `{}` | {} | {} | {} |\n", c.title(), cell(c.symbol), cell(c.meaning), c.required() ? "yes" : "");
  }
  return table;
}

TEST(FormatsDocument, ListsTheColumnsOfTests) {
  expect_section("series columns", column_table(columns_of<Observation>()));
}
TEST(FormatsDocument, ListsTheColumnsOfPredictions) {
  expect_section("prediction columns", column_table(columns_of<predict::PredictedRow>()));
}

TEST(FormatsDocument, ListsTheColumnsOfProbes) {
  std::string table = "| column | symbol | meaning |\n|---|---|---|\n";
  for (const auto& c : columns_of<ProbeRow>())
    table += fmt::format("| `{}` | {} | {} |\n", c.title(), cell(c.symbol), cell(c.meaning));
  expect_section("probe columns", table);
}

std::string range(const Json& s) {
  std::string text = s.contains("type") && s["type"].is_string() ? s["type"].get<std::string>() : "";
  for (const Json& kind : s.value("anyOf", Json::array())) {
    const std::string type = kind["type"];
    text += fmt::format("{}{}", text.empty() ? "" : " or ", type == "string" ? "text" : type);
  }
  const auto add = [&](const char* key, const char* sign) {
    if (s.contains(key)) text += fmt::format(" {} {:g}", sign, s[key].get<double>());
  };
  add("minimum", "≥");
  add("exclusiveMinimum", ">");
  add("maximum", "≤");
  if (s.contains("enum")) {
    text.clear();
    for (const Json& word : s["enum"]) text += fmt::format("{}{}", text.empty() ? "" : ", ", word.dump());
  }
  return text;
}

TEST(FormatsDocument, ListsTheKeysOfASpec) {
  const Json defaults = Json(dem::spec_to_json(dem::spec_from_json(Json::object(), "defaults")));
  std::string table = "| key | value | default | meaning |\n|---|---|---|---|\n";
  const Json& properties = schema(Schema::spec)["properties"];
  for (const auto& item : properties.items()) {
    const bool list = item.key() == "tests" || !defaults.contains(item.key());
    table += fmt::format("| `{}` | {} | {} | {} |\n", item.key(), range(item.value()),
                         list ? (item.key() == "tests" ? "see below" : "–") : cell(defaults[item.key()].dump()),
                         cell(item.value()["description"].get<std::string>()));
  }
  const Json& tests = properties["tests"]["items"]["properties"];
  for (const auto& item : tests.items()) {
    table += fmt::format("| `tests[].{}` | {} |  | {} |\n", item.key(), range(item.value()),
                         cell(item.value()["description"].get<std::string>()));
  }
  expect_section("spec keys", table);
}

std::string key_table(Schema which, const std::vector<std::string>& but = {}) {
  std::string table = "| key | value | meaning |\n|---|---|---|\n";
  for (const auto& item : schema(which)["properties"].items()) {
    if (std::find(but.begin(), but.end(), item.key()) != but.end()) continue;
    table += fmt::format("| `{}` | {} | {} |\n", item.key(), range(item.value()),
                         cell(item.value()["description"].get<std::string>()));
  }
  return table;
}

TEST(FormatsDocument, ListsTheKeysOfATest) {
  std::vector<std::string> shared;
  for (const auto& item : schema(Schema::spec)["properties"].items()) {
    if (item.key() != "keep") shared.push_back(item.key());
  }
  expect_section("test keys", key_table(Schema::test, shared));
}

TEST(FormatsDocument, ListsTheKeysOfAMapping) {
  std::string table = "| key | value | meaning |\n|---|---|---|\n";
  const auto add = [&](const std::string& prefix, const Json& properties) {
    for (const auto& item : properties.items()) {
      if (item.key() == "$schema" || item.key() == "comment" || (!prefix.empty() && item.key() == "series")) continue;
      table += fmt::format("| `{}{}` | {} | {} |\n", prefix, item.key(), range(item.value()),
                           cell(item.value()["description"].get<std::string>()));
    }
  };
  const Json& properties = schema(Schema::mapping)["properties"];
  add("", properties);
  add("packings.NAME.", properties["packings"]["additionalProperties"]["properties"]);
  add("tests[].", properties["tests"]["items"]["properties"]);
  add("series.", properties["series"]["properties"]);
  expect_section("mapping keys", table);
}

/// A struct's fields as keys of a schema: what is missing or differs, as it should read.
template <class T>
void expect_keys(const Json& properties) {
  for_each_field<T>([&](const auto& field) {
    using Value = ValueOf<T, decltype(field.access)>;
    if constexpr (HasFields<Value>) {
      expect_keys<Value>(properties);
    } else {
      if (field.rule == Rule::fixed || field.rule == Rule::free) return;
      Json wanted{{"description", field.meaning + (*field.unit ? fmt::format(" [{}]", field.unit) : "")}};
      if constexpr (NamedEnum<Value>) wanted["enum"] = names_of(Value{});
      if constexpr (std::is_arithmetic_v<Value>)
        wanted["type"] = std::is_same_v<Value, bool> ? "boolean" : std::is_integral_v<Value> ? "integer" : "number";
      const Json found = properties.value(field.name, Json::object());
      for (const auto& item : wanted.items())
        EXPECT_EQ(found.value(item.key(), Json()), item.value()) << "needs \"" << field.name << "\": " << wanted;
    }
  });
}

TEST(Schemas, HaveTheKeysOfTheEnginesOptions) {
  expect_keys<dem::PreparationOptions>(schema(Schema::spec)["properties"]);
  expect_keys<dem::PreparationOptions>(schema(Schema::test)["properties"]);
}

/// The names that a schema allows at a place.
template <class E>
void expect_names(Schema which, const std::string& place, const std::vector<std::string>& but = {}) {
  Json wanted = Json::array();
  for (const std::string name : names_of(E{})) {
    if (std::find(but.begin(), but.end(), name) == but.end()) wanted.push_back(name);
  }
  Json found = schema(which).at(Json::json_pointer(place))["enum"];
  if (found.back().is_null()) found.erase(found.size() - 1);
  EXPECT_EQ(found, wanted) << place;
}

TEST(Schemas, AllowTheNamesOfTheEnums) {
  expect_names<Coupling>(Schema::spec, "/properties/coupling");
  expect_names<Coupling>(Schema::parameters, "/properties/coupling");
  expect_names<Coupling>(Schema::study, "/properties/coupling");
  expect_names<Role>(Schema::spec, "/properties/tests/items/properties/role");
  expect_names<Role>(Schema::dataset, "/properties/tests/items/properties/role");
  expect_names<Branch>(Schema::path, "/properties/initial/properties/branch");
  expect_names<Mode>(Schema::path, "/properties/segments/items/properties/mode", {"tensor"});
  expect_names<Condition::Quantity>(Schema::path,
                                    "/properties/segments/items/properties/free/properties/volume/properties/quantity");
  expect_names<Status>(Schema::parameters, "/properties/parameters/additionalProperties/properties/status");
  expect_names<Rung>(Schema::study_settings, "/properties/settings/items/properties/model");
  expect_names<chain::Cause>(Schema::plan,
                             "/properties/pilot/properties/quantities/items/properties/biases/items/properties/cause");
  Json extents = Json::array();
  for (const auto& item :
       schema(Schema::path)["properties"]["segments"]["items"]["properties"]["extent"]["properties"].items())
    extents.push_back(item.key());
  Json kinds = names_of(ExtentKind{});
  std::sort(kinds.begin(), kinds.end());
  EXPECT_EQ(extents, kinds);
}

TEST(FormatsDocument, StatesTheExitCodes) {
  const std::string text = read_all(kDocument);
  for (const auto& [code, meaning] : {std::pair{ExitCode::ok, "ok"},
                                      {ExitCode::failure, "failure"},
                                      {ExitCode::invalid_input, "invalid input or usage"},
                                      {ExitCode::not_converged, "did not converge"},
                                      {ExitCode::interrupted, "interrupted"}}) {
    EXPECT_NE(text.find(fmt::format("| {} | {}", static_cast<int>(code), meaning)), std::string::npos) << meaning;
  }
}

TEST(FormatsDocument, NamesEveryFileOfASchema) {
  const std::string text = read_all(kDocument);
  for (const char* file : {"spec.schema.json", "path.schema.json", "test.schema.json", "dataset.schema.json",
                           "parameters.schema.json", "study.schema.json", "study_settings.schema.json",
                           "plan.schema.json", "prior.schema.json", "import.schema.json"}) {
    EXPECT_NE(text.find(file), std::string::npos) << file;
    EXPECT_TRUE(std::filesystem::exists(kDocument.parent_path() / "schemas" / file));
  }
}

}  // namespace
}  // namespace grainlaw::app
