#include "model/files/whole_number.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "model/files/fields_json.hpp"

namespace grainlaw {
namespace {

struct Counted {
  std::uint64_t n = 0;
  std::optional<int> i;
};
constexpr auto fields_of(std::type_identity<Counted>) {
  return std::tuple{Field{&Counted::n, "n"}, Field{&Counted::i, "i"}};
}

TEST(WholeNumber, IsTakenWithinItsRangeAlone) {
  EXPECT_EQ(whole_number<std::uint64_t>(std::numeric_limits<std::uint64_t>::max()),
            std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(whole_number<int>(Json(std::numeric_limits<int>::min())), std::numeric_limits<int>::min());
  for (const Json& value : {Json(-1), Json(1e300), Json(2.0), Json("2"), Json(nullptr), Json(true), Json::array({1})})
    EXPECT_THROW(whole_number<std::uint64_t>(value), Json::exception) << value;
  EXPECT_THROW(whole_number<int>(Json(2147483648)), Json::exception);
  EXPECT_THROW(whole_number<std::int64_t>(Json(std::uint64_t{1} << 63)), Json::exception);
}

TEST(WholeNumber, IsWhatFieldsOfThatTypeTake) {
  Counted counted;
  read_fields(Json{{"n", 3}, {"i", nullptr}}, counted);
  EXPECT_EQ(counted.n, 3u);
  EXPECT_FALSE(counted.i);
  EXPECT_THROW(read_fields(Json{{"n", -3}, {"i", 1}}, counted), Json::exception);
  EXPECT_THROW(read_fields(Json{{"n", 3}, {"i", 1e10}}, counted), Json::exception);
}

}  // namespace
}  // namespace grainlaw
