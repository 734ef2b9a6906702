#include "dem/engine/thread_team.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

class ThreadTeamOf : public ::testing::TestWithParam<int> {};

TEST_P(ThreadTeamOf, EachBlockOnce) {
  ThreadTeam team(GetParam());
  EXPECT_EQ(team.threads(), GetParam());
  for (const std::size_t blocks : {0U, 1U, 2U, 7U, 1000U}) {
    std::vector<std::atomic<int>> calls(blocks);
    team.for_each_block(blocks, [&](std::size_t block) { ++calls[block]; });
    for (const auto& count : calls) EXPECT_EQ(count, 1);
  }
}

TEST_P(ThreadTeamOf, ManyShortLoops) {
  ThreadTeam team(GetParam());
  std::vector<long> sums(5, 0);
  for (int k = 0; k < 5000; ++k) {
    team.for_each_block(sums.size(), [&](std::size_t block) { sums[block] += static_cast<long>(block) + k; });
  }
  for (std::size_t block = 0; block < sums.size(); ++block) {
    EXPECT_EQ(sums[block], 5000L * static_cast<long>(block) + 5000L * 4999 / 2);
  }
}

TEST_P(ThreadTeamOf, RethrowsAndStaysUsable) {
  ThreadTeam team(GetParam());
  for (int k = 0; k < 20; ++k) {
    try {
      team.for_each_block(64, [&](std::size_t block) {
        if (block == 13) throw std::runtime_error("block 13");
      });
      FAIL() << "the exception was lost";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()), "block 13");
    }
    std::atomic<int> calls = 0;
    team.for_each_block(64, [&](std::size_t) { ++calls; });
    EXPECT_EQ(calls, 64);
  }
}

// One block waits until all others are done, those of the same member among them.
TEST(ThreadTeam, OthersTakeTheBlocksOfALateMember) {
  constexpr int kBlocks = 64;
  for (const std::size_t late : {0U, 32U}) {  // the first ones of two members
    ThreadTeam team(2);
    std::atomic<int> done = 0;
    team.for_each_block(kBlocks, [&](std::size_t block) {
      const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(60);
      while (block == late && done < kBlocks - 1 && std::chrono::steady_clock::now() < give_up)
        std::this_thread::yield();
      ++done;
      if (block == late) {
        EXPECT_EQ(done, kBlocks);
      }
    });
    EXPECT_EQ(done, kBlocks);
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, ThreadTeamOf, ::testing::Values(1, 2, 3, 8));

TEST(ThreadTeam, RefusesNoThreads) {
  EXPECT_THROW(ThreadTeam(0), InvalidInput);
  EXPECT_THROW(ThreadTeam(-4), InvalidInput);
}

// In a process of its own whose address space ends before the last stack.
TEST(ThreadTeam, SaysWhenThreadsCannotBeStarted) {
#ifdef GRAINLAW_SANITIZED
  GTEST_SKIP() << "sanitizers need the address space themselves";
#endif
  const auto start_too_many = [] {
    const rlimit limit{256 << 20, 256 << 20};  // stacks take 8 MB each
    setrlimit(RLIMIT_AS, &limit);
    try {
      const ThreadTeam team(200);
    } catch (const Error& error) {
      std::fputs(error.what(), stderr);
      std::_Exit(std::string(error.what()).find("give fewer") == std::string::npos);
    }
    std::_Exit(2);
  };
  EXPECT_EXIT(start_too_many(), ::testing::ExitedWithCode(0), "threads: the system does not start as many as 200");
}

TEST(ThreadTeam, BlockCount) {
  EXPECT_EQ(block_count(0), 0U);
  EXPECT_EQ(block_count(1), 1U);
  EXPECT_EQ(block_count(kBlockSize), 1U);
  EXPECT_EQ(block_count(kBlockSize + 1), 2U);
}

}  // namespace
}  // namespace grainlaw::dem
