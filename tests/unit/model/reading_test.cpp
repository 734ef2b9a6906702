#include "model/files/reading.hpp"

#include "model/files/csv_table.hpp"
#include "model/files/digest.hpp"
#include "model/files/foreign_table.hpp"
#include "model/files/json_document.hpp"
#include "tests/support/no_descriptors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw {
namespace {

using grainlaw::testing::NoDescriptors;
using grainlaw::testing::refusal;
using Reading = grainlaw::testing::TemporaryFolder;

/// Message of an Error that is no refusal of the file; what came instead otherwise.
std::string failure(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return std::string("refused: ") + error.what();
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST_F(Reading, GivesAllBytes) {
  const std::string bytes(200000, '\0');
  EXPECT_EQ(read_bytes(put("f", bytes)), bytes);
  EXPECT_EQ(read_bytes(put("empty", "")), "");
}

TEST_F(Reading, RefusesMoreThanItsBound) {
  const std::filesystem::path file = put("f", std::string(200000, 'x'));
  EXPECT_EQ(read_bytes(file, "", 200000, "thin it").size(), 200000u);
  EXPECT_EQ(refusal([&] { read_bytes(file, "", 199999, "thin it"); }),
            file.string() + ": is larger than 0 MB; thin it");
  EXPECT_NE(refusal([] { read_bytes("/dev/zero", "", 1 << 20, "thin it"); }).find("is larger than 1 MB"),
            std::string::npos)
      << "of no size that is known before";
}

// Whoever is refused gives another file, or calls it damaged; neither helps against too many open files.
TEST_F(Reading, TellsAFileThatIsNotThereFromASystemThatFails) {
  const std::filesystem::path none = folder_ / "none", there = put("there.json", "{}");
  const std::vector<std::function<void(const std::filesystem::path&)>> readers{
      [](const auto& file) { read_bytes(file); }, [](const auto& file) { read_json(file, JsonSource::own); },
      [](const auto& file) { sha256_of_file(file); }, [](const auto& file) { CsvReader reader(file); },
      [](const auto& file) { read_foreign_table(file, {}); }};
  for (const auto& read : readers) {
    EXPECT_NE(refusal([&] { read(none); }).find("none: cannot be"), std::string::npos);
    std::string message;
    {
      const NoDescriptors full;
      message = failure([&] { read(there); });
    }
    EXPECT_TRUE(message.starts_with(there.string() + ": cannot be ")) << message;
    EXPECT_NE(message.find("Too many open files"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace grainlaw
