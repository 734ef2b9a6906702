// one_line, digest, output: parts of a few lines each.
#include "model/files/digest.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::app {
namespace {

using testing::refusal;
namespace fs = std::filesystem;

TEST(OneLine, EscapesControlCharactersAndBoundsLength) {
  EXPECT_EQ(one_line("a\nb\x1b[31m\x7f"), "a\\x0ab\\x1b[31m\\x7f");
  EXPECT_EQ(one_line("é ν σ* 😀"), "é ν σ* 😀");
  // a terminal's other escape (CSI in one character), text turned around, a line that ends for a browser, no UTF-8 at all
  EXPECT_EQ(one_line("\u009b31m \u202etxt\u202c \u2028 \u2066"), "\\u009b31m \\u202etxt\\u202c \\u2028 \\u2066");
  EXPECT_EQ(one_line("\x9b\xff\xc3"), "\\x9b\\xff\\xc3");
  EXPECT_EQ(one_line(std::string(100, 'x'), 5), "xxxxx...");
}

TEST(Digest, IsSha256) {
  // FIPS 180-4, examples of one block and of the empty message
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

using Files = testing::TemporaryFolder;

TEST_F(Files, DigestOfAFileIsThatOfItsBytes) {
  const std::string bytes(200000, 'x');
  EXPECT_EQ(sha256_of_file(put("f", bytes)), sha256(bytes));
  EXPECT_THROW(sha256_of_file(folder_ / "none"), Error);
}

// Hard case S6.
TEST_F(Files, KeepOutputInItsFolder) {
  for (const char* name : {"a", "UNI-0.695", "a_b.c", "0", "CONE", "COM0", "com", "LPT12"}) EXPECT_TRUE(is_safe_name(name)) << name;
  for (const char* name : {"", ".", "..", ".hidden", "-x", "a/b", "../x", "/etc", "a\nb", "a b", "é", "a.", "CON", "con", "Nul.csv", "AUX", "prn.x.y", "COM1", "lpt9.csv"})
    EXPECT_FALSE(is_safe_name(name)) << name;
  EXPECT_FALSE(is_safe_name(std::string(101, 'a')));

  fs::create_directory(folder_ / "out");
  fs::create_directory(folder_ / "elsewhere");
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "out" / "runs");
  EXPECT_NE(refusal([&] { make_subfolder(folder_ / "out", "runs"); }).find("symbolic link"), std::string::npos);
  EXPECT_NE(refusal([&] { make_subfolder(folder_ / "out", "../x"); }).find("no name"), std::string::npos);
  put("out/file", "");
  EXPECT_NE(refusal([&] { make_subfolder(folder_ / "out", "file"); }).find("is a file"), std::string::npos);
  EXPECT_NE(refusal([&] { make_output_folder(folder_ / "out" / "file"); }).find("is not a folder"), std::string::npos);
  EXPECT_NE(refusal([&] { make_output_folder("-"); }).find("standard output"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(folder_ / "elsewhere"));
  EXPECT_EQ(make_subfolder(folder_ / "out", "dataset"), folder_ / "out" / "dataset");
  EXPECT_EQ(make_subfolder(folder_ / "out", "dataset"), folder_ / "out" / "dataset");
}

}  // namespace
}  // namespace grainlaw::app
