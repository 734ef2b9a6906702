#include "model/files/schema.hpp"

#include <functional>

#include "fit/calibrate.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::app {
namespace {

using testing::refusal;

std::string schema_refusal(const std::string& text, Schema which = Schema::spec) {
  return refusal([&] { check_schema(parse_json(text, "s.json", JsonSource::user), which, "s.json"); });
}

TEST(SchemaCheck, AcceptsWhatIsDocumented) {
  EXPECT_EQ(schema_refusal("{}"), "accepted");
  EXPECT_EQ(schema_refusal(R"({"particles": 100, "tests": [{"mode": "D2", "density": "all", "role": "calibration"},
                          {"mode": "D2", "density": [0.7], "role": "validation"}, {"mode": "D2", "density": 0.7, "role": "validation"}]})"),
            "accepted");
}

TEST(SchemaCheck, NamesFileKeyReasonAndRemedyInOneLine) {
  EXPECT_EQ(schema_refusal(R"({"particles": 1e18})"),
            "s.json: particles: got 1000000000000000000; give an integer >= 1 and <= 10000000 (number of spheres of a "
            "packing)");
  EXPECT_EQ(
      schema_refusal(R"({"mean_radius": -0.001})"),
      "s.json: mean_radius: got -0.001; give a number >= 1e-09 and <= 1000.0 (mean of the size distribution [m])");
  EXPECT_EQ(schema_refusal(R"({"particle": 5})"), "s.json: unknown key 'particle'; did you mean 'particles'?");
  EXPECT_NE(schema_refusal(R"({"xyzzy": 5})").find("s.json: unknown key 'xyzzy'; known keys: background_viscosity, "),
            std::string::npos);
  EXPECT_EQ(schema_refusal(R"({"tests": [{"mode": "D2"}]})"),
            "s.json: tests[0]: misses the key 'role'; give calibration tests are fitted, validation tests never, "
            "description tests "
            "by laws of their own; on rehearsals the law is judged");
  EXPECT_EQ(schema_refusal(R"({"driving": "sine"})"),
            "s.json: driving: got \"sine\"; give \"cosine\" or \"constant\" (profile of the strain rate in time)");
  EXPECT_EQ(
      schema_refusal(R"({"seeds": [1, 1]})"),
      "s.json: seeds: got [1,1]; give an array of 1 to 1000 different elements (seeds of the packings, all different)");
  EXPECT_EQ(schema_refusal("[]"), "s.json: got []; give an object (an object; every key may be left out)");
}

// Found by the fuzzer: the library that checks takes integers beyond 2^63 for negative ones, -1 here.
TEST(SchemaCheck, RefusesIntegersBeyondThoseWithASign) {
  EXPECT_NE(schema_refusal(R"({"initial": {"nu": 0.7}, "segments": [{"extent": {"eps_dev": 0.1},
                             "rate_tensor": [[-1, 0, 0], [0, 0.5, 0], [0, 0, 18446744073709551615]]}]})",
                           Schema::path)
                .find("rate_tensor[2][2]: got 1.844"),
            std::string::npos);
}

TEST(SchemaCheck, RefusesWrongTypesEverywhere) {
  for (const char* text : {R"({"particles": "100"})",
                           R"({"particles": 100.5})",
                           R"({"particles": null})",
                           R"({"particles": [1]})",
                           R"({"seeds": 1})",
                           R"({"seeds": []})",
                           R"({"seeds": [-1]})",
                           R"({"densities": [0.95]})",
                           R"({"densities": ["0.7"]})",
                           R"({"nu_max": 0.95})",
                           R"({"time_step_fraction": 0})",
                           R"({"time_step_fraction": 0.5})",
                           R"({"size_width": 0.5})",
                           R"({"stiffness": 0})",
                           R"({"tests": {}})",
                           R"({"tests": [{"mode": "D4", "role": "calibration"}]})",
                           R"({"tests": [{"role": "maybe"}]})",
                           R"({"tests": [{"mode": "D2", "density": "some", "role": "calibration"}]})",
                           R"({"tests": [{"mode": "D2", "density": [], "role": "calibration"}]})",
                           R"({"tests": [{"name": "../x", "mode": "D2", "role": "calibration"}]})",
                           R"({"tests": [{"name": "a\nb", "mode": "D2", "role": "calibration"}]})",
                           R"({"tests": [{"mode": "D2", "strain": -0.1, "role": "calibration"}]})"}) {
    const std::string message = schema_refusal(text);
    EXPECT_TRUE(message.starts_with("s.json: ")) << text << " -> " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << text;
  }
}

// Were each value compared with all others, a million would take longer than any test may.
TEST(SchemaCheck, CostGrowsWithTheLengthOfADocumentNotItsSquare) {
  std::string text = "{\"densities\": [";
  for (int i = 1; i < 1000000; ++i) text += "0.7,";
  EXPECT_NE(schema_refusal(text + "0.7]}").find("densities"), std::string::npos);
}

TEST(SchemaCheck, TellsAllViolationsWhereAsked) {
  const auto violations = [](const char* text) {
    return schema_violations(parse_json(text, "s.json", JsonSource::user), Schema::spec, "s.json");
  };
  EXPECT_TRUE(violations("{}").empty());
  const std::vector<std::string> all = violations(
      R"({"particle": 1, "seed": 2, "nu_max": 2, "tests": [{"mode": "D4", "rol": 1}, {"role": "calibration"}]})");
  for (const char* wanted : {"s.json: unknown key 'particle'; did you mean 'particles'?",
                             "s.json: unknown key 'seed'; did you mean 'seeds'?",
                             "s.json: tests[0]: unknown key 'rol'; did you mean 'role'?"})
    EXPECT_EQ(std::count(all.begin(), all.end(), wanted), 1) << wanted;
  const auto begins = [&](const char* start) {
    return std::count_if(all.begin(), all.end(), [&](const std::string& text) { return text.starts_with(start); });
  };
  for (const char* start : {"s.json: tests[0].mode: got \"D4\"", "s.json: tests[0]: misses the key 'role'",
                            "s.json: nu_max: got 2; give a number"})
    EXPECT_EQ(begins(start), 1) << start;
  EXPECT_EQ(all.size(), 6u);  // and nothing of the objects around them
}

TEST(SchemaCheck, LetsEveryInputNameItsSchemaAndTakesItsExamples) {
  for (const auto& [which, name] : {std::pair{Schema::spec, "spec"},
                                    {Schema::path, "path"},
                                    {Schema::test, "test"},
                                    {Schema::dataset, "dataset"},
                                    {Schema::parameters, "parameters"},
                                    {Schema::prior, "prior"},
                                    {Schema::plan, "plan"},
                                    {Schema::mapping, "import"}}) {
    const Json& s = schema(which);
    EXPECT_TRUE(s["properties"].contains("$schema") && s["properties"]["$schema"]["type"] == "string") << name;
    EXPECT_TRUE(s.contains("title") && s.contains("description") && s.value("allowComments", false)) << name;
    for (Json example : s.value("examples", Json::array())) {
      example["$schema"] = "file:///usr/share/grainlaw/schemas/" + std::string(name) + ".schema.json";
      example["comment"] = Json({"one line", "another"});
      EXPECT_EQ(schema_violations(example, which, name), std::vector<std::string>{}) << example.dump();
    }
  }
  for (const Schema which : {Schema::spec, Schema::path, Schema::test, Schema::dataset, Schema::mapping})
    EXPECT_GT(schema(which).value("examples", Json::array()).size(), 0u);
}

/// Every key that a user may write says what to give.
void expect_described(const Json& node, const std::string& place) {
  if (!node.is_object()) return;
  if (node.contains("properties")) {
    for (const auto& item : node["properties"].items()) {
      EXPECT_TRUE(item.value().contains("description")) << place << "." << item.key();
      expect_described(item.value(), place + "." + item.key());
    }
  }
  if (node.contains("items")) expect_described(node["items"], place + "[]");
}

TEST(SchemaCheck, DescribesEveryKey) {
  for (const Schema which :
       {Schema::spec, Schema::path, Schema::test, Schema::dataset, Schema::parameters, Schema::prior, Schema::mapping})
    expect_described(schema(which), "");
}

void expect_bounded_integers(const Json& node, const std::string& place) {
  if (!node.is_structured()) return;
  if (node.is_object() && node.contains("type") && node["type"] == "integer" && !node.contains("enum")) {
    EXPECT_TRUE(node.contains("minimum") && node.contains("maximum")) << place;
  }
  for (const auto& item : node.items()) expect_bounded_integers(item.value(), place + "." + item.key());
}

// What no integer of the program holds would be read as another number.
TEST(SchemaCheck, BoundsEveryInteger) {
  for (const Schema which : {Schema::spec, Schema::path, Schema::test, Schema::dataset, Schema::parameters,
                             Schema::study, Schema::study_settings, Schema::plan, Schema::prior, Schema::mapping})
    expect_bounded_integers(schema(which), std::to_string(static_cast<int>(which)));
}

TEST(SchemaCheck, KnowsTheWordsOfTheFit) {
  const Json& status =
      schema(Schema::parameters)["properties"]["parameters"]["additionalProperties"]["properties"]["status"]["enum"];
  std::vector<std::string> words;
  for (const auto s : {Status::fitted, Status::fixed, Status::tied, Status::at_bound, Status::not_identified})
    words.push_back(to_string(s));
  EXPECT_EQ(status, Json(words));
}

}  // namespace
}  // namespace grainlaw::app
