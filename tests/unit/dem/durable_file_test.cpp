#include "model/files/output.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tests/support/temporary_folder.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

using DurableFile = grainlaw::testing::TemporaryFolder;

TEST_F(DurableFile, IsReplacedWhole) {
  put("f", "old");
  write_durably(folder_ / "f", "new content");
  EXPECT_EQ(content(folder_ / "f"), "new content");
  copy_durably(folder_ / "f", folder_ / "g");
  EXPECT_EQ(content(folder_ / "g"), "new content");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator{}), 2);
}

TEST_F(DurableFile, SecondNameIsOfTheSameFileUntilOneIsWritten) {
  put("f", "frame");
  put("g", "old");
  for (int again = 0; again < 2; ++again) {  // the second time both are one file already
    link_or_copy(folder_ / "f", folder_ / "g");
    EXPECT_EQ(content(folder_ / "g"), "frame");
    EXPECT_EQ(fs::hard_link_count(folder_ / "f"), 2u);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator{}), 2);
  }
  write_whole(folder_ / "g", "other");
  EXPECT_EQ(content(folder_ / "f"), "frame");
  EXPECT_EQ(content(folder_ / "g"), "other");
  sync_files_below(folder_);
  EXPECT_THROW(sync_files_below(folder_ / "none"), Error);
  EXPECT_THROW(link_or_copy(folder_ / "none", folder_ / "h"), Error);
  fs::create_symlink(folder_ / "f", folder_ / "link");
  link_or_copy(folder_ / "g", folder_ / "link");
  EXPECT_EQ(content(folder_ / "f"), "frame") << "not through a link";
}

TEST_F(DurableFile, IsNotWrittenThroughALink) {
  put("victim", "untouched");
  fs::create_symlink(folder_ / "victim", folder_ / "f");
  write_durably(folder_ / "f", "ours");
  EXPECT_EQ(content(folder_ / "victim"), "untouched");
  EXPECT_FALSE(fs::is_symlink(folder_ / "f"));
}

// A file that the user named: what it is stays what it is.
TEST_F(DurableFile, OfTheUsersChoiceIsNeverReplacedByAnotherKind) {
  put("target", "old");
  fs::create_symlink("target", folder_ / "link");
  fs::create_symlink("link", folder_ / "link_to_link");
  write_as_named(folder_ / "link_to_link", "new");
  EXPECT_EQ(content(folder_ / "target"), "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link_to_link") && fs::is_symlink(folder_ / "link"));
  fs::create_symlink("not yet", folder_ / "dangling");
  write_as_named(folder_ / "dangling", "made");
  EXPECT_EQ(content(folder_ / "not yet"), "made");
  fs::create_symlink("loop", folder_ / "loop");
  EXPECT_THROW(write_as_named(folder_ / "loop", "x"), Error);
  EXPECT_THROW(write_as_named(folder_, "x"), InvalidInput);

  const fs::path fifo = folder_ / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const int reader = ::open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
  write_as_named(fifo, "through");
  char got[16] = {};
  EXPECT_EQ(::read(reader, got, sizeof got), 7);
  ::close(reader);
  EXPECT_STREQ(got, "through");
  EXPECT_TRUE(fs::is_fifo(fifo));
  if (fs::exists("/dev/full")) {
    EXPECT_THROW(write_as_named("/dev/full", "x"), Error);
  }
}

// Hard case R8: a write that fails leaves the earlier file and nothing else.
TEST_F(DurableFile, SurvivesAFailingWrite) {
  put("f", "old");
  const auto earlier = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{}, small{};
  getrlimit(RLIMIT_FSIZE, &limit);
  small = limit;
  small.rlim_cur = 1000;
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(write_durably(folder_ / "f", std::string(100000, 'x')), Error);
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, earlier);
  EXPECT_EQ(content(folder_ / "f"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator{}), 1);
  EXPECT_THROW(write_durably(folder_ / "none" / "f", "x"), Error);
}

TEST_F(DurableFile, LeftoversOfKilledProcessesAreRemoved) {
  // a child that is killed amid writing: it may write no more than 1000 bytes, and the signal for that kills it
  const pid_t child = fork();
  if (child == 0) {
    const rlimit small{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &small);
    write_durably(folder_ / "a.csv", std::string(100000, 'x'));
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  const auto files = [&] { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator{}); };
  ASSERT_EQ(files(), 1);

  const fs::path of_living = put(".b.csv.tmp-1-0", "x");
  const int writing = open(of_living.c_str(), O_WRONLY);
  flock(writing, LOCK_EX);
  for (const char* other : {".hidden", "a.tmp-1-0"}) put(other, "x");
  remove_leftovers(folder_);
  EXPECT_EQ(files(), 3);
  EXPECT_TRUE(fs::exists(of_living));
  close(writing);
  remove_leftovers(folder_);
  EXPECT_EQ(files(), 2);
  remove_leftovers(folder_ / "none");
}

}  // namespace
}  // namespace grainlaw::dem
