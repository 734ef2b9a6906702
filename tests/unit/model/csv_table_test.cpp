#include "model/files/csv_table.hpp"

#include <sys/resource.h>

#include <cmath>
#include <limits>

#include "tests/support/temporary_folder.hpp"

namespace grainlaw {
namespace {

using testing::refusal;

class CsvTable : public testing::TemporaryFolder {
 protected:
  std::vector<std::vector<double>> read(const std::string& text) const {
    CsvReader reader(put("t.csv", text));
    std::vector<std::vector<double>> rows;
    std::vector<double> row;
    while (reader.next(row)) rows.push_back(row);
    return rows;
  }
  std::string refusal_of(const std::string& text) const {
    const std::string message = refusal([&] { read(text); });
    const auto name = message.find("t.csv: ");
    return name == std::string::npos ? message : message.substr(name + 7);
  }
};

TEST_F(CsvTable, ReadsNumbersAndEmptyFields) {
  const auto rows = read("a,b[m]\n1,-2.5e-3\r\n,0.1");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0], (std::vector<double>{1, -2.5e-3}));
  EXPECT_TRUE(std::isnan(rows[1][0]));
  EXPECT_EQ(rows[1][1], 0.1);
}

// Hard case S3.
TEST_F(CsvTable, RefusesHostileTextNamingRowAndColumn) {
  EXPECT_NE(refusal_of("a,b\n1,2\n3,x\n").find("row 2, column 'b': 'x' is not a finite number"), std::string::npos);
  EXPECT_NE(refusal_of("a,b\n1,5,2\n").find("row 1: 3 fields where the header has 2"),
            std::string::npos);  // 1,5 for 1.5
  EXPECT_NE(refusal_of("a,b\n1\n").find("row 1: 1 fields"), std::string::npos);
  EXPECT_NE(refusal_of("a,b\n1,2\n\n3,4\n").find("row 2: 1 fields"), std::string::npos);
  EXPECT_NE(refusal_of(std::string("a,b\n1,2\n3,\0"
                                   "4\n",
                                   12))
                .find("row 2: holds a NUL byte"),
            std::string::npos);
  EXPECT_NE(refusal_of("a,a\n1,2\n").find("column 'a' is given twice"), std::string::npos);
  EXPECT_NE(refusal_of("").find("is empty"), std::string::npos);
  EXPECT_NE(refusal_of("\xEF\xBB\xBF"
                       "a,b\n1,2\n")
                .find("byte order mark"),
            std::string::npos);
  for (const char* field : {"nan", "NaN", "inf", "-inf", "1e309", "0x10", " 1", "1 ", "1.5.2", "1_000", "--1", "+1"}) {
    EXPECT_NE(refusal_of(std::string("a,b\n1,2\n3,") + field + "\n").find("row 2, column 'b'"), std::string::npos)
        << field;
  }
}

TEST_F(CsvTable, StaysSmallWithHugeLinesAndManyColumns) {
  const auto file = put("huge.csv", "a,b\n1,2\n");
  std::filesystem::resize_file(file, std::uintmax_t{1} << 30);  // a sparse line of 1 GB of NUL bytes
  EXPECT_NE(refusal([&] {
              CsvReader reader(file);
              std::vector<double> row;
              while (reader.next(row)) {
              }
            }).find("row 2: the line is longer than"),
            std::string::npos);
  std::string columns = "a0";
  for (int i = 1; i < 100000; ++i) columns += ",a";
  EXPECT_NE(refusal_of(columns + "\n").find("more than 1000 columns"), std::string::npos);
  EXPECT_NE(refusal_of("a,b\n" + std::string(5000, ',') + "\n").find("row 1: more than 1000 fields"),
            std::string::npos);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 500 * 1024);  // [kB]
}

TEST(CsvNumber, IsShortestAndExact) {
  EXPECT_EQ(csv_number(0.1), "0.1");
  EXPECT_EQ(csv_number(-0.0), "-0");
  EXPECT_EQ(csv_number(1e300), "1e+300");
  EXPECT_EQ(csv_number(std::nan("")), "");
  EXPECT_THROW(csv_number(std::numeric_limits<double>::infinity()), Error);
}

}  // namespace
}  // namespace grainlaw
