// Locks that processes share: one at a time, and of a dead owner exactly one goes on.
#include "model/files/process_lock.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class Locks : public testing::TemporaryFolder {
 protected:
  fs::path place() const { return folder_ / "key.lock"; }

  /// The lock of a process on another machine that was heard of `silent` ago.
  void put_owner_elsewhere(std::chrono::seconds silent) const {
    fs::create_directory(place());
    const fs::path file = put("key.lock/node7,1,1,elsewhere,0", "");
    fs::last_write_time(file, fs::file_time_type::clock::now() - silent);
  }

  bool is_empty() const { return fs::is_empty(folder_); }
};

/// `work` in a process of its own, whose exit code is what it returns.
template <class Work>
pid_t in_a_process(const Work& work) {
  const pid_t pid = fork();
  if (pid == 0) _exit(work());
  return pid;
}

int exit_code_of(pid_t pid) {
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(Locks, HoldOffOthersUntilGivenBack) {
  auto lock = ProcessLock::try_lock(place());
  ASSERT_TRUE(lock);
  EXPECT_FALSE(ProcessLock::try_lock(place()));
  EXPECT_EQ(exit_code_of(in_a_process([&] { return ProcessLock::try_lock(place()) ? 1 : 0; })), 0);
  EXPECT_NE(lock_owner(place()).value().find("process " + std::to_string(getpid())), std::string::npos);
  remove_dead_locks(folder_);
  EXPECT_TRUE(lock_owner(place()));
  lock.reset();
  EXPECT_TRUE(is_empty());
  EXPECT_FALSE(lock_owner(place()));
  EXPECT_TRUE(ProcessLock::try_lock(place()));
}

TEST_F(Locks, AreHeldByOneProcessAtATime) {
  constexpr int kProcesses = 6, kRounds = 40;
  const fs::path inside = folder_ / "inside", count = folder_ / "count";
  std::vector<pid_t> processes;
  for (int i = 0; i < kProcesses; ++i) {
    processes.push_back(in_a_process([&] {
      for (int round = 0; round < kRounds;) {
        const auto lock = ProcessLock::try_lock(place());
        if (!lock) continue;
        const int file = open(inside.c_str(), O_CREAT | O_EXCL | O_WRONLY, 0666);
        if (file < 0) return 1;  // another is inside
        close(file);
        std::ofstream(count, std::ios::app) << "x";
        unlink(inside.c_str());
        ++round;
      }
      return 0;
    }));
  }
  for (const pid_t process : processes) EXPECT_EQ(exit_code_of(process), 0);
  EXPECT_EQ(content(count).size(), static_cast<std::size_t>(kProcesses * kRounds));
}

TEST_F(Locks, OfAKilledProcessAreTakenOver) {
  for (const bool awaited : {false, true}) {  // before and after its exit code was asked for
    const pid_t holder = in_a_process([&] {
      const auto lock = ProcessLock::try_lock(place());
      put("held", "");
      pause();
      return 0;
    });
    while (!fs::exists(folder_ / "held")) usleep(1000);
    EXPECT_FALSE(ProcessLock::try_lock(place()));
    kill(holder, SIGKILL);
    if (awaited) {
      exit_code_of(holder);
    } else {
      siginfo_t ended;
      waitid(P_PID, static_cast<id_t>(holder), &ended, WEXITED | WNOWAIT);
    }
    EXPECT_FALSE(lock_owner(place()));
    EXPECT_TRUE(ProcessLock::try_lock(place())) << awaited;
    if (!awaited) exit_code_of(holder);
    fs::remove(folder_ / "held");
    EXPECT_TRUE(is_empty());
  }
}

// A number of a process that has ended may be another's now.
TEST_F(Locks, KnowAProcessByItsStart) {
  std::string owner;
  {
    const auto lock = ProcessLock::try_lock(place());
    owner = fs::directory_iterator(place())->path().filename().string();
  }
  const std::size_t pid = owner.find(',') + 1, start = owner.find(',', pid) + 1, end = owner.find(',', start);
  fs::create_directory(place());
  put("key.lock/" + owner, "");
  EXPECT_FALSE(ProcessLock::try_lock(place()));
  fs::remove(place() / owner);
  put("key.lock/" + owner.replace(start, end - start, "1"), "");
  EXPECT_TRUE(ProcessLock::try_lock(place()));
}

TEST_F(Locks, OfAnotherMachineAreTakenOverAfterSilenceByOne) {
  put_owner_elsewhere(kSilence - 60s);
  EXPECT_FALSE(ProcessLock::try_lock(place()));
  EXPECT_EQ(lock_owner(place()), "process 1 on node7");
  remove_dead_locks(folder_);
  EXPECT_TRUE(lock_owner(place()));
  fs::remove_all(place());

  for (int repeat = 0; repeat < 20; ++repeat) {
    put_owner_elsewhere(kSilence + 60s);
    EXPECT_FALSE(lock_owner(place()));
    std::vector<pid_t> processes;
    for (int i = 0; i < 6; ++i) {
      processes.push_back(in_a_process([&] {
        while (!fs::exists(folder_ / "go")) {
        }
        const auto lock = ProcessLock::try_lock(place());
        put("tried-" + std::to_string(i), "");
        while (!fs::exists(folder_ / "end")) usleep(100);
        return lock ? 1 : 0;
      }));
    }
    put("go", "");
    for (int i = 0; i < 6; ++i) {
      while (!fs::exists(folder_ / ("tried-" + std::to_string(i)))) usleep(100);
      fs::remove(folder_ / ("tried-" + std::to_string(i)));
    }
    put("end", "");
    int winners = 0;
    for (const pid_t process : processes) winners += exit_code_of(process);
    EXPECT_EQ(winners, 1);
    fs::remove(folder_ / "go");
    fs::remove(folder_ / "end");
    ASSERT_TRUE(is_empty());
  }
}

TEST_F(Locks, BeatAndNoticeThatTheyWereTaken) {
  const auto lock = ProcessLock::try_lock(place(), 5ms);
  const fs::path file = fs::directory_iterator(place())->path();
  const auto before = fs::file_time_type::clock::now() - 1h;
  fs::last_write_time(file, before);
  const auto until = std::chrono::steady_clock::now() + 10s;
  while (fs::last_write_time(file) == before && std::chrono::steady_clock::now() < until) usleep(1000);
  EXPECT_GT(fs::last_write_time(file), before + 30min);
  EXPECT_FALSE(lock->lost().stop_requested());
  fs::remove(file);  // as one who believes its owner dead does
  while (!lock->lost().stop_requested() && std::chrono::steady_clock::now() < until) usleep(1000);
  EXPECT_TRUE(lock->lost().stop_requested());
}

TEST_F(Locks, WaitUntilGivenBackOrInterrupted) {
  auto held = ProcessLock::try_lock(place());
  std::string told;
  std::stop_source stop;
  std::jthread later([&] {
    std::this_thread::sleep_for(50ms);
    held.reset();
  });
  EXPECT_TRUE(ProcessLock::wait(place(), stop.get_token(), [&](const std::string& owner) { told = owner; }));
  EXPECT_NE(told.find("process "), std::string::npos);
  later.join();
  held = ProcessLock::try_lock(place());
  later = std::jthread([&] { stop.request_stop(); });
  EXPECT_THROW(ProcessLock::wait(place(), stop.get_token(), [](const std::string&) {}), Interrupted);
}

TEST_F(Locks, LeaveAloneWhatIsNotTheirs) {
  fs::create_directory(place());
  put("key.lock/notes", "mine");
  EXPECT_THROW(ProcessLock::try_lock(place()), Error);
  remove_dead_locks(folder_);
  EXPECT_EQ(content(place() / "notes"), "mine");
  fs::create_directory(folder_ / "other");
  fs::create_directory_symlink(folder_ / "other", folder_ / "link.lock");
  EXPECT_NE(testing::refusal([&] { ProcessLock::try_lock(folder_ / "link.lock"); }).find("symbolic link"),
            std::string::npos);
  EXPECT_THROW(ProcessLock::try_lock(folder_ / "none" / "key.lock"), Error);
}

TEST_F(Locks, OfKilledOnesAreSwept) {
  put_owner_elsewhere(kSilence + 60s);
  fs::create_directory(folder_ / ".lock-node7,1,1,elsewhere,3");  // before it was renamed
  fs::last_write_time(folder_ / ".lock-node7,1,1,elsewhere,3", fs::file_time_type::clock::now() - 1h);
  fs::create_directory(folder_ / "empty.lock");
  remove_dead_locks(folder_);
  EXPECT_TRUE(is_empty());
}

}  // namespace
}  // namespace grainlaw
