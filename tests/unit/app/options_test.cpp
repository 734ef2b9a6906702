#include "app/commands/options.hpp"

#include <numeric>

#include "tests/support/temporary_folder.hpp"

namespace grainlaw::app {
namespace {

using Seeds = std::vector<std::uint64_t>;

std::string refused_seeds(const std::string& text) {
  try {
    seeds_of("--seeds", text);
  } catch (const CLI::ValidationError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SeedsOf, TakesSeedsAndRangesInTheirOrder) {
  EXPECT_EQ(seeds_of("--seeds", "201-205"), (Seeds{201, 202, 203, 204, 205}));
  EXPECT_EQ(seeds_of("--seeds", "1,3,7-9"), (Seeds{1, 3, 7, 8, 9}));
  EXPECT_EQ(seeds_of("--seeds", "9,4-4,0"), (Seeds{9, 4, 0}));
  EXPECT_EQ(seeds_of("--seeds", "1-1000").size(), 1000u);
  EXPECT_EQ(seeds_of("--seeds", "9007199254740991-9007199254740992").size(), 2u);  // up to the largest
}

TEST(SeedsOf, RefusesWhatIsNoneAndTooMany) {
  for (const char* text : {"", "a", "1,", ",1", "3-1", "-3", "1-", "1-2-3", "1.5", "0x3", " 1", "18446744073709551616"})
    EXPECT_NE(refused_seeds(text).find("give seeds and ranges of them"), std::string::npos) << text;
  for (const char* text : {"1-1001", "1-999,5-6", "0-9007199254740992"})
    EXPECT_NE(refused_seeds(text).find("at most 1000"), std::string::npos) << text << refused_seeds(text);
  for (const char* text : {"9007199254740993", "1-9007199254740993", "18446744073709551615"})
    EXPECT_NE(refused_seeds(text).find("up to 9007199254740992"), std::string::npos) << text << refused_seeds(text);
}

TEST(Between, NamesItsRange) {
  const CLI::Validator validator = between(0, 1e6);
  for (std::string good : {"0", "1e6", "3.5"}) EXPECT_EQ(validator(good), "") << good;
  for (std::string bad : {"-1", "1000001", "x", "", "nan", "1 2"})
    EXPECT_EQ(validator(bad), "got '" + bad + "'; give a number, 0 to 1e+06") << bad;
}

TEST(Chosen, IsTheIndexOfTheWord) {
  EXPECT_EQ(chosen("--loss", "huber", {"squares", "huber"}), 1u);
  EXPECT_THROW(chosen("--loss", "Huber?", {"squares", "huber"}), CLI::ValidationError);
  EXPECT_THROW(chosen("--loss", "", {"squares", "huber"}), CLI::ValidationError);
}

TEST(AddNumber, IsNeverOctal) {
  CLI::App app;
  int whole = 0;
  double real = -1;
  add_number(app, "--whole", whole, 1, 100, "N", "");
  add_number(app, "--real", real, 0, 100, "X", "");
  EXPECT_THROW(app.parse("--whole 010"), CLI::ValidationError) << "8 to the parser of numbers";
  app.parse("--whole 10 --real 0.5");
  EXPECT_EQ(whole, 10);
  EXPECT_EQ(real, 0.5);
  app.parse("--real 0");
  EXPECT_EQ(real, 0);
}

}  // namespace
}  // namespace grainlaw::app
