#include "model/files/foreign_table.hpp"

#include <cmath>
#include <limits>

#include "model/files/npy.hpp"
#include "model/files/npz.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw {
namespace {

using testing::refusal;

ForeignTable text(const std::string& content, TableLayout layout = {}) {
  return table_of_text(content, "t.txt", layout);
}
std::string text_refusal(const std::string& content, const TableLayout& layout = {}) {
  return refusal([&] { text(content, layout); });
}

void expect_titles(const ForeignTable& table, const std::vector<std::string>& titles) {
  ASSERT_EQ(table.columns.size(), titles.size());
  for (std::size_t i = 0; i < titles.size(); ++i) EXPECT_EQ(table.columns[i].title, titles[i]);
}

TEST(ForeignText, IsReadWithAnyDelimiter) {
  for (const std::string d : {",", ";", "\t", " ", "   ", " , ", " ; "}) {
    const ForeignTable table = text("a" + d + "sxx[kPa]\n1" + d + "-2.5e3\r\n\n+3" + d + "4\n");
    expect_titles(table, {"a", "sxx[kPa]"});
    EXPECT_EQ(table.columns[0].values, (std::vector<double>{1, 3})) << d;
    EXPECT_EQ(table.columns[1].values, (std::vector<double>{-2500, 4})) << d;
    EXPECT_EQ(table.lines, (std::vector<std::size_t>{2, 4}));
    EXPECT_EQ(table.place(1), "t.txt: line 4");
  }
}

TEST(ForeignText, HasItsHeaderInAComment) {
  expect_titles(text("# e_xx p q\n1 2 3\n"), {"e_xx", "p", "q"});  // GrainLearning
  expect_titles(text("#made by somebody\n#a,b\n1,2\n"), {"a", "b"});
  expect_titles(text("# a and b\n1,2\n"), {"1", "2"});  // another comment
  expect_titles(text("1 2 # c\n"), {"1", "2"});
  expect_titles(text("1 2\n", {.names = {"x", "y"}}), {"x", "y"});
  expect_titles(text("\xEF\xBB\xBF\"a\";\"b\"\n1;2\n"), {"a", "b"});
}

TEST(ForeignText, HasDecimalCommasWhereThatIsSaid) {
  const TableLayout commas{.decimal = ','};
  for (const std::string d : {";", "\t", " "}) {
    const ForeignTable table = text("a" + d + "b\n1,5" + d + "-2,5e-3\n3" + d + ",5\n", commas);
    EXPECT_EQ(table.columns[0].values, (std::vector<double>{1.5, 3})) << d;
    EXPECT_EQ(table.columns[1].values, (std::vector<double>{-0.0025, 0.5})) << d;
  }
  for (const std::string word : {"1.5", "1.234,5", "1,234,567"}) {
    EXPECT_EQ(text("a;b\n1;" + word + "\n", commas).columns[1].bad, word);
  }
  EXPECT_EQ(text("a;b\n1;1,5\n").columns[1].bad, "1,5");
  EXPECT_NE(text_refusal("a b\n1,5\n", commas).find("have decimal commas"), std::string::npos);
}

TEST(ForeignText, HasALineOfUnitsBelowItsHeader) {
  const ForeignTable table = text("a;b;c;d [%]\n[kPa];;( mm ) ; \n1;2;3;4\nx;y;z;w\n");
  expect_titles(table, {"a[kPa]", "b", "c[mm]", "d [%]"});
  EXPECT_EQ(table.lines, (std::vector<std::size_t>{3, 4}));
  for (const ForeignColumn& column : table.columns)
    EXPECT_EQ(column.bad_row, 1u) << "a second line is no line of units";
  expect_titles(text("a b\nkPa %\n1 2\n", {.names = {"x", "y"}}), {"x[kPa]", "y[%]"});
  for (const std::string row : {"nan kPa", "1 kPa", "1,5 -2,5", "-,5 kPa"}) {
    const ForeignTable rows = text("a b\n" + row + "\n1 2\n", {.delimiter = ' '});
    expect_titles(rows, {"a", "b"});
    EXPECT_EQ(rows.rows(), 2u) << row;
  }
  expect_titles(text("1 2\nkPa %\n", {.names = {"a", "b"}}), {"a", "b"});  // no header to stand below
  EXPECT_NE(text_refusal("a b\nkPa\n1 2\n").find("line 2: 1 words where there are 2"), std::string::npos);
}

TEST(ForeignText, SkipsLinesAboveItsHeader) {
  const ForeignTable table = text("Sample 7, height 100 mm\n\n1;2\na;b\n3;4\n", {.skip = 3});
  expect_titles(table, {"a", "b"});
  EXPECT_EQ(table.place(0), "t.txt: line 5");
  EXPECT_NE(text_refusal("a b\n1 2\n", {.skip = 2}).find("has no rows"), std::string::npos);
}

TEST(ForeignText, KeepsWhatIsNoNumberByName) {
  const ForeignTable table = text("a,b\n1,\nnan,x\n");
  EXPECT_TRUE(std::isnan(table.columns[0].values[1]) && std::isnan(table.columns[1].values[0]));
  EXPECT_TRUE(table.columns[0].bad.empty());
  EXPECT_EQ(table.columns[1].bad, "x");
  EXPECT_EQ(table.columns[1].bad_row, 1u);
}

TEST(ForeignText, RefusesWithTheLine) {
  EXPECT_EQ(
      text_refusal("a;b\n1,5;2;3\n"),
      "t.txt: line 2: 3 words where there are 2 columns; numbers have decimal points, and what is undefined is nan or "
      "empty between delimiters; lines above the header are left out by skip");
  EXPECT_NE(text_refusal("a,a\n1,2\n").find("columns 1 and 2 are both called 'a'"), std::string::npos);
  EXPECT_NE(text_refusal("a b\n").find("has no rows"), std::string::npos);
  EXPECT_NE(text_refusal("").find("has no rows"), std::string::npos);
  EXPECT_NE(text_refusal(std::string("a\n1\0\n", 5)).find("NUL"), std::string::npos);
  EXPECT_NE(text_refusal("a b\n1 2\n", {.names = {"x"}}).find("2 columns where names has 1"), std::string::npos);
}

/// A file of numpy with that header and data.
std::string npy(const std::string& header, const std::string& data) {
  const std::size_t length = header.size();
  return std::string(kNpyMagic) + '\1' + '\0' + static_cast<char>(length % 256) + static_cast<char>(length / 256) +
         header + data;
}
std::string npy_of(const std::string& descr, const std::string& shape, const std::string& data,
                   const std::string& order = "False") {
  return npy("{'descr': " + descr + ", 'fortran_order': " + order + ", 'shape': " + shape + ", }\n", data);
}
ForeignTable table_of(const std::string& bytes) { return table_of_npy(parse_npy(bytes, "a.npy"), "a.npy"); }

const std::string kOneAndHalf = std::string("\0\0\0\0\0\0\xF8\x3F", 8);  // 1.5, little endian
std::string reversed(std::string bytes) { return {bytes.rbegin(), bytes.rend()}; }

TEST(Npy, ReadsEveryKindOfNumber) {
  EXPECT_EQ(table_of(npy_of("'<f8'", "(1,)", kOneAndHalf)).columns[0].values[0], 1.5);
  EXPECT_EQ(table_of(npy_of("'>f8'", "(1,)", reversed(kOneAndHalf))).columns[0].values[0], 1.5);
  const std::string single("\0\0\xC0\x3F", 4), minus_two("\xFE\xFF\xFF\xFF", 4);
  EXPECT_EQ(table_of(npy_of("'<f4'", "(1,)", single)).columns[0].values[0], 1.5);
  EXPECT_EQ(table_of(npy_of("'>f4'", "(1,)", reversed(single))).columns[0].values[0], 1.5);
  EXPECT_EQ(table_of(npy_of("'<i4'", "(1,)", minus_two)).columns[0].values[0], -2);
  EXPECT_EQ(table_of(npy_of("'>i8'", "(1,)", "\xFF\xFF\xFF\xFF" + reversed(minus_two))).columns[0].values[0], -2);
}

TEST(Npy, ReadsRowsColumnsAndRecords) {
  const auto column = [](const ForeignTable& table, std::size_t k) { return table.columns.at(k).values; };
  const auto i4 = [](std::initializer_list<int> numbers) {
    std::string bytes;
    for (const int n : numbers) bytes += std::string{static_cast<char>(n), 0, 0, 0};
    return bytes;
  };
  const ForeignTable c = table_of(npy_of("'<i4'", "(2, 3)", i4({1, 2, 3, 4, 5, 6})));
  const ForeignTable fortran = table_of(npy_of("'<i4'", "(2, 3)", i4({1, 4, 2, 5, 3, 6}), "True"));
  for (const ForeignTable& table : {c, fortran}) {
    expect_titles(table, {"1", "2", "3"});
    EXPECT_EQ(column(table, 0), (std::vector<double>{1, 4}));
    EXPECT_EQ(column(table, 2), (std::vector<double>{3, 6}));
  }
  const ForeignTable records = table_of(npy_of("[('a', '<i4'), ('b', '<f8')]", "(1,)", i4({7}) + kOneAndHalf));
  expect_titles(records, {"a", "b"});
  EXPECT_EQ(column(records, 0)[0], 7);
  EXPECT_EQ(column(records, 1)[0], 1.5);
}

TEST(Npy, RefusesAllElse) {
  const auto why = [](const std::string& bytes) { return refusal([&] { table_of(bytes); }); };
  EXPECT_NE(why(npy_of("'|O'", "(1,)", "12345678")).find("pickled"), std::string::npos);
  EXPECT_NE(why(npy_of("'<f2'", "(1,)", "12")).find("'<f2'"), std::string::npos);
  EXPECT_NE(why(npy_of("[('a', '<f8', (3,))]", "(1,)", "")).find("misses ')'"), std::string::npos);
  EXPECT_NE(why(npy_of("'<f8'", "(2,)", kOneAndHalf)).find("holds 8 bytes"), std::string::npos);
  EXPECT_NE(why(npy_of("'<f8'", "(1,)", kOneAndHalf + "x")).find("holds 9 bytes"), std::string::npos);
  EXPECT_NE(why(npy_of("'<f8'", "(4294967296, 4294967296, 4294967296)", "")).find("beyond"), std::string::npos);
  EXPECT_NE(why(npy_of("'<f8'", "(500000000, 500000000, 500000000)", "")).find("too many"), std::string::npos);
  EXPECT_NE(why(npy_of("'<f8'", "()", kOneAndHalf)).find("0 dimensions"), std::string::npos);
  EXPECT_NE(why(npy("__import__('os')", "")).find("misses '{'"), std::string::npos);
  EXPECT_NE(why(std::string(kNpyMagic) + "\1").find("ends within"), std::string::npos);
  const std::string sound = npy_of("'<f8'", "(1,)", kOneAndHalf);
  for (std::size_t n = 0; n < sound.size(); ++n) EXPECT_NE(why(sound.substr(0, n)), "accepted") << n;
}

/// numpy.savez_compressed(sxx=[1.5, -2, 1e6], step=array([1, 2, 3], '>i4'), note='hello').
std::string archive() {
  const std::string hex =
      "504b030414000000080000002100bcd9a58a5200000098000000070014007378782e6e707901001000980000000000000052000000000000"
      "009bec17"
      "ea1b10c9c850c650ad9e925a9c5ca46ea5a06e9366a1aea3a09e965f54529498179f5f94920a12774bcc294e058a17672416a402f91ac63a"
      "9a3a0ab5"
      "0a14002e0630f8610fa1190e808886163d4700504b030414000000080000002100129ea8ee4d0000008c00000008001400737465702e6e70"
      "79010010"
      "008c000000000000004d000000000000009bec17ea1b10c9c850c650ad9e925a9c5ca46ea5a06e9769a2aea3a09e965f54529498179f5f94"
      "920a1277"
      "4bcc294e058a17672416a402f91ac63a9a3a0ab50a14002e06060646206602626600504b0304140000000800000021009a3729f34e000000"
      "94000000"
      "080014006e6f74652e6e70790100100094000000000000004e000000000000009bec17ea1b10c9c850c650ad9e925a9c5ca46ea5a06e136a"
      "aaaea3a0"
      "9e965f54529498179f5f94920a12774bcc294e058a17672416a402f91a9a3a0ab50a1401ae0c0606865420ce81e27c200600504b01021403"
      "14000000"
      "080000002100bcd9a58a52000000980000000700000000000000000000008001000000007378782e6e7079504b0102140314000000080000"
      "0021001"
      "29ea8ee4d0000008c00000008000000000000000000000080018b000000737465702e6e7079504b01021403140000000800000021009a372"
      "9f34e00"
      "0000940000000800000000000000000000008001120100006e6f74652e6e7079504b05060000000003000300a10000009a0100000000";
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

TEST(Npz, HasAnArrayForEachColumn) {
  const ForeignTable table = table_of_npz(archive(), "a.npz", "");
  expect_titles(table, {"sxx", "step"});
  EXPECT_EQ(table.columns[0].values, (std::vector<double>{1.5, -2, 1e6}));
  EXPECT_EQ(table.columns[1].values, (std::vector<double>{1, 2, 3}));
  ASSERT_EQ(table.left_out.size(), 1u);
  EXPECT_NE(table.left_out[0].find("note"), std::string::npos);
  EXPECT_EQ(table_of_npz(archive(), "a.npz", "step").columns[0].values[2], 3);
}

TEST(Npz, RefusesWhatIsDamaged) {
  const auto why = [](const std::string& bytes, const std::string& array = "") {
    return refusal([&] { table_of_npz(bytes, "a.npz", array); });
  };
  EXPECT_NE(why(archive(), "syy").find("holds no array 'syy'"), std::string::npos);
  EXPECT_NE(why(archive(), "note").find("type '<U5'"), std::string::npos);
  std::string workbook = archive();
  for (std::size_t at = 0; (at = workbook.find("step.npy", at)) != std::string::npos;)
    workbook.replace(at, 8, "a/1b.xml");
  EXPECT_NE(why(workbook).find("'a/1b.xml' is no .npy; write it anew with numpy.savez, or save the sheet of a workbook "
                               "(.xlsx, .ods) as CSV"),
            std::string::npos)
      << why(workbook);
  const std::string sound = archive();
  for (std::size_t n = 0; n < sound.size(); n += 7) EXPECT_NE(why(sound.substr(0, n)), "accepted") << n;
  std::string flipped = sound;
  flipped[70] = static_cast<char>(flipped[70] ^ 0x10);  // within the first array
  EXPECT_NE(why(flipped), "accepted");
}

class ForeignFile : public testing::TemporaryFolder {};

TEST_F(ForeignFile, IsKnownByItsFirstBytes) {
  EXPECT_EQ(read_foreign_table(put("a.dat", archive()), {}).columns.size(), 2u);
  EXPECT_EQ(read_foreign_table(put("b.dat", npy_of("'<f8'", "(1,)", kOneAndHalf)), {}).columns[0].values[0], 1.5);
  EXPECT_EQ(read_foreign_table(put("c.npz", "a b\n1 2\n"), {}).columns[1].values[0], 2);
  EXPECT_NE(refusal([&] { read_foreign_table(folder_, {}); }).find("is no regular file"), std::string::npos);
  EXPECT_NE(refusal([&] { read_foreign_table(folder_ / "none", {}); }).find("cannot be opened"), std::string::npos);
  EXPECT_NE(refusal([&] { read_foreign_table(put("d.npy", npy_of("'<f8'", "(0,)", "")), {}); }).find("has no rows"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw
