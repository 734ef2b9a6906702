#include "model/files/json_document.hpp"

#include <cmath>
#include <limits>

#include "tests/support/temporary_folder.hpp"

namespace grainlaw {
namespace {

using testing::refusal;

std::string json_refusal(const std::string& text, JsonSource source = JsonSource::user) {
  return refusal([&] { parse_json(text, "x.json", source); });
}

TEST(JsonDocument, ReadsWhatJsonAllows) {
  const Json document =
      parse_json(R"( {"a": [1, -2, 2.5, true, null, "\u00e9"], "b": {"c": []}} )", "x.json", JsonSource::user);
  EXPECT_EQ(document.dump(), R"({"a":[1,-2,2.5,true,null,"é"],"b":{"c":[]}})");
  EXPECT_EQ(parse_json("3", "x.json", JsonSource::user), Json(3));
}

TEST(JsonDocument, TakesWholeNumbersOfUsersAsIntegers) {
  EXPECT_TRUE(parse_json("[2e3, -0.0]", "x.json", JsonSource::any)[0].is_number_integer())
      << "and -0 is no reason to refuse";
  EXPECT_TRUE(parse_json("[2e3]", "x.json", JsonSource::user)[0].is_number_integer());
  EXPECT_TRUE(parse_json("[2000.0]", "x.json", JsonSource::own)[0].is_number_float());
}

// Hard case S1.
TEST(JsonDocument, RefusesHostileTextWithPlaceAndReason) {
  EXPECT_NE(json_refusal(R"({"a": {"b": [1, NaN]}})").find("x.json: a.b[1]: "), std::string::npos)
      << json_refusal(R"({"a": {"b": [1, NaN]}})");
  EXPECT_NE(json_refusal(R"({"nu": 1e309})").find("x.json: nu: "), std::string::npos);
  EXPECT_EQ(json_refusal(R"({"nu": -0})"), "x.json: nu: negative zero is refused; write 0");
  EXPECT_EQ(json_refusal(R"({"nu": -0.0})"), "x.json: nu: negative zero is refused; write 0");
  EXPECT_EQ(json_refusal(R"({"a": {"b": 1, "b": 2}})"), "x.json: a.b: is given twice; keep one");
  EXPECT_EQ(json_refusal(R"([{"b": 1, "b": 2}])"), "x.json: [0].b: is given twice; keep one");
  EXPECT_NE(json_refusal("\xEF\xBB\xBF{}").find("byte order mark"), std::string::npos);
  EXPECT_NE(json_refusal("{\"a\": \"\xff\"}").find("UTF-8"), std::string::npos);
  EXPECT_NE(json_refusal(std::string("{}\0", 3)).find("x.json: "), std::string::npos);
  for (const char* broken :
       {"", "{", "[1,]", "{\"a\":}", "{} {}", "# c\n{}", "/* {}", "'a'", "01", "+1", ".5", "Infinity", "{\"a\" 1}"}) {
    EXPECT_NE(json_refusal(broken), "accepted") << broken;
    EXPECT_EQ(json_refusal(broken).find('\n'), std::string::npos) << broken;
  }
}

TEST(JsonDocument, SkipsCommentsOfUsersAlone) {
  const std::string text = "// of the file\n{\"a\": /* inside */ [1, 2], // of a line\n \"b\": \"http://x\"}\n// end";
  EXPECT_EQ(parse_json(text, "x.json", JsonSource::user), Json({{"a", {1, 2}}, {"b", "http://x"}}));
  EXPECT_THROW(parse_json(text, "x.json", JsonSource::own), InvalidInput);
}

TEST(JsonDocument, LimitsNestingWhileParsing) {
  const auto nested = [](int n) {
    return std::string(static_cast<std::size_t>(n), '[') + std::string(static_cast<std::size_t>(n), ']');
  };
  EXPECT_EQ(json_refusal(nested(kMaxJsonDepth)), "accepted");
  EXPECT_NE(json_refusal(nested(kMaxJsonDepth + 1)).find("nested deeper"), std::string::npos);
  // refused before the end is seen, where another error waits
  EXPECT_NE(json_refusal(std::string(512000, '[')).find("nested deeper"), std::string::npos);
  std::string objects;
  for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
  EXPECT_NE(json_refusal(objects).find("nested deeper"), std::string::npos);
}

TEST(JsonDocument, KeepsEveryDoubleBitForBit) {
  std::uint64_t bits = 88172645463325252ull;
  for (int i = 0; i < 20000; ++i) {
    bits ^= bits << 13, bits ^= bits >> 7, bits ^= bits << 17;  // xorshift: all exponents and signs
    double value;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    const double back = parse_json(json_text({{"v", value}}), "x.json", JsonSource::own)["v"].get<double>();
    EXPECT_EQ(std::memcmp(&back, &value, sizeof value), 0) << value;
  }
  for (const double value : {0.0, -0.0, 5e-324, std::numeric_limits<double>::max(), 0.1, 1.0}) {
    const double back = parse_json(json_text({{"v", value}}), "x.json", JsonSource::own)["v"].get<double>();
    EXPECT_EQ(std::memcmp(&back, &value, sizeof value), 0) << value;
  }
}

TEST(JsonDocument, WritesUndefinedAsNullAndNeverANonFiniteNumber) {
  EXPECT_TRUE(number_or_null(std::nan("")).is_null());
  EXPECT_EQ(number_or_null(1.5), OrderedJson(1.5));
  EXPECT_TRUE(std::isnan(number_or_nan(Json(nullptr))));
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(json_text({{"a", {{"b", value}}}}), Error);
    try {
      json_text({{"a", {{"b", value}}}});
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("a.b"), std::string::npos) << error.what();
    }
  }
}

TEST(JsonDocument, WritesArraysOfNumbersOnOneLine) {
  EXPECT_EQ(json_text({{"a", {1, 2.5}}, {"b", OrderedJson::object()}, {"c", {{{"d", "x"}}}}}),
            "{\n  \"a\": [1, 2.5],\n  \"b\": {},\n  \"c\": [\n    {\n      \"d\": \"x\"\n    }\n  ]\n}\n");
}

using JsonFile = testing::TemporaryFolder;

TEST_F(JsonFile, IsReadBackAsWritten) {
  const OrderedJson document{{"z", 1}, {"a", {0.1, nullptr, "text \"quoted\"\n"}}};
  write_json(folder_ / "d.json", document);
  EXPECT_EQ(read_json(folder_ / "d.json", JsonSource::own), Json(document));
}

TEST_F(JsonFile, IsRefusedWhenAbsentAFolderOrTooLarge) {
  EXPECT_NE(refusal([&] { read_json(folder_ / "none.json", JsonSource::user); }).find("none.json: cannot be opened"),
            std::string::npos);
  EXPECT_NE(refusal([&] { read_json(folder_, JsonSource::user); }).find("is a folder"), std::string::npos);
  const auto large = put("large.json", "");
  std::filesystem::resize_file(large, kMaxJsonBytes + 1);  // sparse
  EXPECT_NE(refusal([&] { read_json(large, JsonSource::user); }).find("larger than"), std::string::npos);
}

}  // namespace
}  // namespace grainlaw
