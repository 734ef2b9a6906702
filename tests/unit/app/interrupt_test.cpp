#include "app/terminal/interrupt.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdlib>
#include <thread>

namespace grainlaw::app {
namespace {

class Interrupt : public ::testing::Test {
 protected:
  // libraries have threads, too, which a bare fork does not take along
  Interrupt() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

void wish() {
  const InterruptGuard guard;
  raise(SIGTERM);
  while (!guard.token().stop_requested()) std::this_thread::yield();
}

TEST_F(Interrupt, TheSecondSignalOfOneWishDoesNotEndAProcessThatIsEnding) {
  // as by timeout(1), of which the second comes when the work has stopped and the exit code is on its way
  const auto interrupted = [] {
    wish();
    raise(SIGTERM);
    raise(SIGINT);
    std::_Exit(7);
  };
  EXPECT_EXIT(interrupted(), ::testing::ExitedWithCode(7), "");
}

TEST_F(Interrupt, AnotherWishEndsIt) {
  const auto interrupted = [] {
    wish();
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    raise(SIGINT);
    std::_Exit(7);
  };
  EXPECT_EXIT(interrupted(), ::testing::ExitedWithCode(130), "");
}

TEST_F(Interrupt, WithoutOneTheHandlersOfBeforeAreBack) {
  const auto undisturbed = [] {
    { const InterruptGuard guard; }
    raise(SIGTERM);
    std::_Exit(7);
  };
  EXPECT_EXIT(undisturbed(), ::testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace grainlaw::app
