#include "dem/runs/job_list.hpp"

#include "app/terminal/progress_printer.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <regex>
#include <thread>

#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

using namespace std::chrono_literals;

struct Quiet {
  ProgressPrinter printer{stderr, true};
};

TEST(JobList, RunsEveryJobOnceAndAfterWhatItNeeds) {
  for (const int threads : {1, 2, 3, 8}) {
    Quiet quiet;
    std::mutex mutex;
    std::vector<int> order;
    std::vector<dem::Job> jobs;
    for (int i = 0; i < 20; ++i) {
      jobs.push_back({std::to_string(i), 1,
                      i >= 3 ? std::optional<std::size_t>(static_cast<std::size_t>(i % 3)) : std::nullopt,
                      [&, i](int, const RunControl&) {
                        const std::lock_guard lock(mutex);
                        order.push_back(i);
                      }});
    }
    dem::run_jobs(jobs, threads, quiet.printer, {});
    ASSERT_EQ(order.size(), 20u);
    std::vector<int> position(20);
    for (int k = 0; k < 20; ++k) position[static_cast<std::size_t>(order[static_cast<std::size_t>(k)])] = k;
    for (int i = 3; i < 20; ++i)
      EXPECT_GT(position[static_cast<std::size_t>(i)], position[static_cast<std::size_t>(i % 3)]);
  }
}

TEST(JobList, SharesTheThreads) {
  Quiet quiet;
  std::atomic<int> in_use = 0, most = 0, given = 0;
  std::vector<dem::Job> jobs;
  for (int i = 0; i < 6; ++i) {
    jobs.push_back({"job", 1, std::nullopt, [&](int threads, const RunControl&) {
                      const int now = in_use += threads;
                      int seen = most;
                      while (now > seen && !most.compare_exchange_weak(seen, now)) {
                      }
                      std::this_thread::sleep_for(5ms);
                      in_use -= threads;
                    }});
  }
  dem::run_jobs(jobs, 3, quiet.printer, {});
  EXPECT_LE(most, 3);
  // a single job gets all
  dem::run_jobs({{"only", 1, std::nullopt, [&](int threads, const RunControl&) { given = threads; }}}, 5, quiet.printer,
                {});
  EXPECT_EQ(given, 5);
}

TEST(JobList, StopsTheOthersWhenOneFailsAndReportsThatOne) {
  Quiet quiet;
  std::atomic<int> started = 0;
  std::vector<dem::Job> jobs;
  jobs.push_back({"waits", 1, std::nullopt, [&](int, const RunControl& control) {
                    ++started;
                    while (!control.stop.stop_requested()) std::this_thread::sleep_for(1ms);
                    throw Interrupted("waits");
                  }});
  jobs.push_back({"fails", 1, std::nullopt, [&](int, const RunControl&) {
                    ++started;
                    throw Error("energy balance");
                  }});
  jobs.push_back({"depends", 1, 1, [&](int, const RunControl&) { ++started; }});
  try {
    dem::run_jobs(jobs, 2, quiet.printer, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "energy balance");
  }
  EXPECT_EQ(started, 2);
}

TEST(JobList, DoesOthersFirstWhileOneIsDoneElsewhere) {
  Quiet quiet;
  std::atomic<bool> released = false;
  std::atomic<int> asked = 0, run = 0;
  std::vector<dem::Job> jobs;
  jobs.push_back({"elsewhere", 1, std::nullopt, [&](int, const RunControl&) { ADD_FAILURE(); },
                  [&] {
                    ++asked;
                    return released ? dem::Claim::finished : dem::Claim::elsewhere;
                  }});
  jobs.push_back({"after it", 1, 0, [&](int, const RunControl&) {
                    EXPECT_TRUE(released);
                    ++run;
                  }});
  jobs.push_back({"other", 1, std::nullopt, [&](int, const RunControl&) {
                    ++run;
                    released = true;
                  }});
  jobs.push_back(
      {"found", 0, std::nullopt, [&](int, const RunControl&) { ADD_FAILURE(); }, [] { return dem::Claim::finished; }});
  dem::run_jobs(jobs, 1, quiet.printer, {});
  EXPECT_EQ(run, 2);
  EXPECT_GE(asked, 2);
}

TEST(JobList, AsksAgainForWhatWasTakenOver) {
  Quiet quiet;
  int asked = 0, run = 0;
  const auto claim = [&] { return ++asked == 1 ? dem::Claim::mine : dem::Claim::finished; };
  dem::run_jobs({{"taken", 1, std::nullopt,
                  [&](int, const RunControl&) {
                    ++run;
                    throw dem::TakenOver();
                  },
                  claim}},
                2, quiet.printer, {});
  EXPECT_EQ(run, 1);
  EXPECT_EQ(asked, 2);
}

TEST(JobList, IsInterruptedWhileItWaitsAndFailsWithAClaim) {
  Quiet quiet;
  std::stop_source stop;
  const std::jthread later([&] {
    std::this_thread::sleep_for(30ms);
    stop.request_stop();
  });
  const auto never = [](int, const RunControl&) { ADD_FAILURE(); };
  EXPECT_THROW(dem::run_jobs({{"elsewhere", 1, std::nullopt, never, [] { return dem::Claim::elsewhere; }}}, 1,
                             quiet.printer, stop.get_token()),
               Interrupted);
  const auto fails = []() -> dem::Claim { throw Error("no space"); };
  EXPECT_THROW(dem::run_jobs({{"fails", 1, std::nullopt, never, fails}}, 1, quiet.printer, {}), Error);
}

TEST(JobList, StopsOnRequest) {
  Quiet quiet;
  std::stop_source stop;
  std::atomic<int> finished = 0;
  std::vector<dem::Job> jobs;
  for (int i = 0; i < 4; ++i) {
    jobs.push_back({"job", 1, std::nullopt, [&, i](int, const RunControl& control) {
                      if (i == 0) {
                        ++finished;
                        return;
                      }
                      stop.request_stop();
                      while (!control.stop.stop_requested()) std::this_thread::sleep_for(1ms);
                      throw Interrupted("stopped");
                    }});
  }
  EXPECT_THROW(dem::run_jobs(jobs, 2, quiet.printer, stop.get_token()), Interrupted);
  EXPECT_EQ(finished, 1);
  EXPECT_THROW(dem::run_jobs(jobs, 2, quiet.printer, stop.get_token()),
               Interrupted);  // already requested: nothing starts
  EXPECT_EQ(finished, 1);
}

TEST(ProgressPrinter, WritesPlainLinesToAFile) {
  std::FILE* out = std::tmpfile();
  ASSERT_NE(out, nullptr);
  ProgressPrinter printer(out, false);
  printer.begin({100, 0}, "particle-steps");
  const RunControl control = printer.control(0, "seed 1", {});
  control.report({"loading", 0.5, 50, "particle-steps"});
  printer.log("two\nlines");
  printer.finished(0);
  printer.end();
  std::rewind(out);
  std::string all(1000, '\0');
  all.resize(std::fread(all.data(), 1, all.size(), out));
  std::fclose(out);
  EXPECT_EQ(all, "grainlaw: two\\x0alines\n");  // no bar, no escape sequences, nothing within the first seconds
}

// Without a unit the parts count by their shares: a fifth in 5 s leaves 20 s.
TEST(ProgressPrinter, TellsShareStageAndTimeLeftOfAFit) {
  std::FILE* out = std::tmpfile();
  ProgressPrinter printer(out, false);
  printer.begin({4, 0, 1}, "");
  const RunControl control = printer.control(0, "fit", {});
  std::this_thread::sleep_for(5100ms);  // a line every five seconds
  control.report({"evolution", 0.25, 3, "iterations"});
  printer.finished(0);
  printer.control(2, "other modes", {});
  printer.end();
  std::rewind(out);
  std::string all(1000, '\0');
  all.resize(std::fread(all.data(), 1, all.size(), out));
  std::fclose(out);
  EXPECT_TRUE(std::regex_match(all, std::regex("grainlaw:  20 %, 0:2[0-9] left \\(fit, evolution\\)\n"))) << all;
}

TEST(ProgressPrinter, QuietSaysNothing) {
  std::FILE* out = std::tmpfile();
  ProgressPrinter printer(out, true);
  printer.log("warning");
  std::fseek(out, 0, SEEK_END);
  EXPECT_EQ(std::ftell(out), 0);
  std::fclose(out);
}

TEST(ClockText, IsMinutesAndHours) {
  EXPECT_EQ(clock_text(41.2), "0:42");
  EXPECT_EQ(clock_text(3723), "1:02:03");
}

}  // namespace
}  // namespace grainlaw::app
