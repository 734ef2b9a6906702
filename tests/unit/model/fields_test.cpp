#include "model/vocabulary/fields.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "model/files/column.hpp"
#include "model/files/fields_json.hpp"
#include "model/vocabulary/observation.hpp"

namespace grainlaw {
namespace fields_test {

enum class Colour { red, green };
constexpr auto names_of(Colour) { return std::array{"red", "green"}; }

struct Part {
  double mass = 1;
  bool hollow = false;
};
constexpr auto fields_of(std::type_identity<Part>) {
  return std::tuple{Field{&Part::mass, "mass", "kg", "m", "of the part"}, Field{&Part::hollow, "hollow"}};
}
static_assert(tells_every_member<Part>());

struct Whole {
  std::string name = "none";
  Part part;
  Colour colour = Colour::red;
  std::optional<double> end;
  std::vector<Part> others;
  int threads = 1;
  double tolerance = 0.5;
};
constexpr auto fields_of(std::type_identity<Whole>) {
  using W = Whole;
  return std::tuple{Field{&W::name, "name"},
                    Field{&W::part, ""},
                    Field{&W::colour, "colour"},
                    Field{&W::end, "end"},
                    Field{&W::others, "others"},
                    Field{&W::threads, "threads", "", "", "", Rule::free},
                    Field{&W::tolerance, "tolerance", "", "", "", Rule::fixed}};
}
static_assert(tells_every_member<Whole>());

struct Half {
  int told = 0, forgotten = 0;
};
constexpr auto fields_of(std::type_identity<Half>) { return std::tuple{Field{&Half::told, "told"}}; }
static_assert(!tells_every_member<Half>());

}  // namespace fields_test

namespace {

using fields_test::Colour;
using fields_test::Part;
using fields_test::Whole;

TEST(Fields, BecomeKeysInTheirOrder) {
  Whole whole;
  whole.part = {std::numeric_limits<double>::quiet_NaN(), true};
  whole.colour = Colour::green;
  whole.others = {{2.5, false}};
  EXPECT_EQ(fields_to_json(whole).dump(), R"({"name":"none","mass":null,"hollow":true,"colour":"green","end":null,)"
                                          R"("others":[{"mass":2.5,"hollow":false}]})");
  EXPECT_EQ(fields_to_json(whole, true)["tolerance"], 0.5);
}

TEST(Fields, AreReadBack) {
  Whole whole;
  whole.end = 0.25;
  whole.colour = Colour::green;
  whole.others = {{1, true}, {2, false}};
  Whole read;
  read_fields(Json(fields_to_json(whole)), read);
  EXPECT_EQ(fields_to_json(read), fields_to_json(whole));
}

TEST(Fields, ThatAreMissingAreNamedUnlessTheyMayBe) {
  Whole whole;
  read_given_fields(Json{{"mass", 3}, {"colour", "green"}, {"tolerance", 9}, {"threads", 9}}, whole);
  EXPECT_EQ(whole.part.mass, 3);
  EXPECT_EQ(whole.colour, Colour::green);
  EXPECT_EQ(whole.name, "none");
  EXPECT_EQ(whole.tolerance, 0.5) << "no key of a file";
  EXPECT_EQ(whole.threads, 1);
  EXPECT_THROW(read_fields(Json{{"name", "a"}}, whole), Json::out_of_range);
}

TEST(EnumNames, GoBothWays) {
  EXPECT_EQ(to_string(Colour::green), "green");
  EXPECT_EQ(value_of<Colour>("red", "colour"), Colour::red);
  EXPECT_EQ(find_value<Colour>("blue"), std::nullopt);
  try {
    value_of<Colour>("blue", "colour");
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "colour: 'blue' is none; give one of red, green");
  }
}

TEST(Columns, FollowFromTheFields) {
  EXPECT_EQ(csv_header<Part>(), "mass[kg],hollow");
  EXPECT_EQ(csv_line(Part{0.5, true}), "0.5,1");
  std::size_t tensors = 0;
  for (const auto& column : columns_of<Observation>()) tensors += column.name.starts_with("stress_kinetic_");
  EXPECT_EQ(tensors, 6u);
}

TEST(RowOfASeries, HasRatiosOfJammedShearOnly) {
  Eigen::Matrix3d stress = Eigen::Vector3d(1, 1, 4).asDiagonal();  // P = 2, |sigma'| = 3
  const Deviator<double> sigma = deviator<double>(stress), F = deviator<double>(0.1 * stress);
  const Deviator<double> N = sigma / sigma.norm(), none = Deviator<double>::Zero();
  Observation row;
  set_ratios(row, 2, sigma, F, -N);
  EXPECT_DOUBLE_EQ(row.s_dev, 1.5);
  EXPECT_DOUBLE_EQ(row.s_par, -1.5);
  EXPECT_DOUBLE_EQ(row.F_dev, 0.3);
  EXPECT_DOUBLE_EQ(row.F_par, -0.3);
  set_ratios(row, 2, sigma, F, none);
  EXPECT_DOUBLE_EQ(row.s_dev, 1.5);
  EXPECT_TRUE(std::isnan(row.s_par) && std::isnan(row.F_par));
  set_ratios(row, 0, none, none, N);
  EXPECT_TRUE(std::isnan(row.s_dev) && std::isnan(row.s_par));
  EXPECT_EQ(row.F_par, 0);
}

}  // namespace
}  // namespace grainlaw
