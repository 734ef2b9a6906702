// The solver when the right-hand side misbehaves (hard case O14): no call may end with a y that is not finite, at another
// t than asked, or wrong. dy/dt = -y with y_0 = 1 and faults sown at the n-th evaluation, for each n of a whole run.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "predict/cvode.hpp"

namespace grainlaw::predict {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Method kMethods[] = {Method::adams, Method::bdf};

struct Outcome {
  Arrival arrival;
  double y = kNaN;
  SolverStatistics statistics;
};

/// Integrates a scalar equation from y(0) = 1 to `t`.
Outcome integrate(const std::function<double(double t, double y)>& rate, double t, Method method,
                  long max_steps = 10000, OdeEvent event = {}) {
  Cvode solver(
      1, {1e-8, 1e-12, method, max_steps}, [&](double at, const double* y, double* out) { out[0] = rate(at, y[0]); },
      std::move(event));
  std::array<double, 1> y{1};
  solver.start(0, y, t);
  Outcome run;
  run.arrival = solver.advance(t, y);
  run.y = y[0];
  run.statistics = solver.statistics();
  return run;
}

double decay(double, double y) { return -y; }

TEST(Solver, DecayIsRight) {
  for (const Method method : kMethods) {
    const Outcome run = integrate(decay, 2, method);
    EXPECT_EQ(run.arrival.kind, Arrival::Kind::reached) << run.arrival.message;
    EXPECT_EQ(run.arrival.t, 2);
    EXPECT_NEAR(run.y, std::exp(-2.0), 1e-7);
    EXPECT_GT(run.statistics.rhs_evaluations, 10);
  }
}

TEST(Solver, O14OneFaultAtAnyEvaluationIsSurvivedOrReported) {
  int survived = 0, reported = 0;
  for (const Method method : kMethods) {
    for (const double fault : {kNaN, kInfinity, -kInfinity}) {
      const long evaluations = integrate(decay, 2, method).statistics.rhs_evaluations;
      for (long n = 1; n <= evaluations; ++n) {
        long call = 0;
        const Outcome run = integrate([&](double, double y) { return ++call == n ? fault : -y; }, 2, method);
        if (run.arrival.kind == Arrival::Kind::reached) {
          ++survived;
          EXPECT_EQ(run.arrival.t, 2);
          EXPECT_NEAR(run.y, std::exp(-2.0), 1e-7) << "fault at evaluation " << n;
        } else {
          ++reported;
          EXPECT_EQ(run.arrival.kind, Arrival::Kind::failed);
          EXPECT_FALSE(run.arrival.message.empty());
          EXPECT_TRUE(std::isnan(run.y)) << "no half result";
        }
      }
    }
  }
  EXPECT_GT(survived, 100) << "a smaller step gets round a single fault";
  EXPECT_GT(reported, 0) << "but not at the first evaluation";
}

TEST(Solver, O14LastingFaultsAreReported) {
  for (const Method method : kMethods) {
    for (const double from : {0.0, 1e-9, 0.5, 1.999}) {
      for (const double fault : {kNaN, kInfinity}) {
        const Outcome run = integrate([&](double t, double y) { return t >= from ? fault : -y; }, 2, method);
        EXPECT_EQ(run.arrival.kind, Arrival::Kind::failed) << "from t = " << from;
        EXPECT_NE(run.arrival.message, "");
        EXPECT_LE(run.arrival.t, std::max(from, 1e-9));
        EXPECT_TRUE(std::isnan(run.y));
      }
    }
  }
}

TEST(Solver, O14OverflowWithFiniteRatesIsReported) {
  for (const Method method : kMethods) {
    const Outcome run = integrate([](double, double) { return std::numeric_limits<double>::max(); }, 2, method);
    EXPECT_EQ(run.arrival.kind, Arrival::Kind::failed) << run.y;
    EXPECT_TRUE(std::isnan(run.y));
  }
}

TEST(Solver, O14StateThatOverflowsIsReported) {
  // The error test of the solver is passed by what is not a number.
  for (const Method method : kMethods) {
    Cvode solver(1, {1e-8, 1e-12, method}, [](double, const double*, double* rate) { rate[0] = 1e308; });
    std::array<double, 1> y{1.7e308};
    solver.start(0, y, 2);
    const Arrival arrival = solver.advance(2, y);
    EXPECT_EQ(arrival.kind, Arrival::Kind::failed) << y[0];
    EXPECT_TRUE(std::isnan(y[0]));
  }
}

TEST(Solver, O14StepLimitIsReported) {
  for (const Method method : kMethods) {
    const Outcome run = integrate(decay, 2, method, 3);
    EXPECT_EQ(run.arrival.kind, Arrival::Kind::failed);
    EXPECT_NE(run.arrival.message.find("mxstep"), std::string::npos) << run.arrival.message;
    EXPECT_LT(run.arrival.t, 2);
    EXPECT_TRUE(std::isnan(run.y));
  }
}

TEST(Solver, O14VanishingStepIsReported) {
  // dy/dt = y^2 has y = 1/(1 - t): no step leads past t = 1.
  for (const Method method : kMethods) {
    const Outcome run = integrate([](double, double y) { return y * y; }, 2, method);
    EXPECT_EQ(run.arrival.kind, Arrival::Kind::failed) << "y(2) = " << run.y;
    EXPECT_NEAR(run.arrival.t, 1, 1e-3);
    EXPECT_TRUE(std::isnan(run.y));
  }
}

TEST(Solver, O14EventThatIsNoNumberIsReported) {
  for (const Method method : kMethods) {
    const Outcome run = integrate(decay, 2, method, 10000, [](double t, const double*) { return t > 1 ? kNaN : 1.0; });
    EXPECT_EQ(run.arrival.kind, Arrival::Kind::failed);
    EXPECT_TRUE(std::isnan(run.y));
  }
}

TEST(Solver, EventIsLocated) {
  for (const Method method : kMethods) {
    const Outcome run = integrate(decay, 2, method, 10000, [](double, const double* y) { return y[0] - 0.5; });
    EXPECT_EQ(run.arrival.kind, Arrival::Kind::event);
    EXPECT_NEAR(run.arrival.t, std::log(2.0), 1e-7);
    EXPECT_NEAR(run.y, 0.5, 1e-8);
  }
}

TEST(Solver, RisingEventIsNone) {
  const Outcome run = integrate(decay, 2, Method::adams, 10000, [](double, const double* y) { return 0.5 - y[0]; });
  EXPECT_EQ(run.arrival.kind, Arrival::Kind::reached);
}

TEST(Solver, ExceptionsPassThrough) {
  struct Odd {};
  for (const Method method : kMethods) {
    EXPECT_THROW(
        integrate([](double t, double y) -> double { return t > 1 ? throw std::runtime_error("x") : -y; }, 2, method),
        std::runtime_error);
    EXPECT_THROW(integrate([](double, double) -> double { throw Odd{}; }, 2, method), Odd);
    EXPECT_THROW(integrate(decay, 2, method, 100, [](double, const double*) -> double { throw Odd{}; }), Odd);
  }
}

TEST(Solver, GoesOnAfterAFailureWhenStartedAnew) {
  bool broken = true;
  Cvode solver(1, {}, [&](double, const double* y, double* rate) { rate[0] = broken ? kNaN : -y[0]; });
  std::array<double, 1> y{1};
  solver.start(0, y, 1);
  EXPECT_EQ(solver.advance(1, y).kind, Arrival::Kind::failed);
  broken = false;
  y[0] = 1;
  solver.start(0, y, 1);
  EXPECT_EQ(solver.advance(1, y).kind, Arrival::Kind::reached);
  EXPECT_NEAR(y[0], std::exp(-1.0), 1e-7);
  EXPECT_EQ(solver.statistics().restarts, 2);
}

TEST(Solver, RelativeToleranceRefersToTheScaleWhereThereIsOne) {
  // y = sin t as a small part of something of size 1e4.
  for (const Method method : kMethods) {
    double off[2] = {}, evaluations[2] = {};
    for (const bool scaled : {false, true}) {
      Cvode solver(
          1, {1e-9, 1e-13, method}, [](double t, const double*, double* rate) { rate[0] = std::cos(t); }, {},
          scaled ? OdeScale([](double, const double*, double* scale) { scale[0] = 1e4; }) : OdeScale{});
      std::array<double, 1> y{0};
      solver.start(0, y, 3.14);
      ASSERT_EQ(solver.advance(3.14, y).kind, Arrival::Kind::reached);
      off[scaled] = std::abs(y[0] - std::sin(3.14));
      evaluations[scaled] = static_cast<double>(solver.statistics().rhs_evaluations);
    }
    EXPECT_LT(off[0], 50 * 1e-9);
    EXPECT_LT(off[1], 50 * 1e-9 * 1e4);
    EXPECT_GT(off[1], 50 * 1e-9) << "and not smaller than asked for";
    EXPECT_LT(evaluations[1], 0.5 * evaluations[0]);
  }
}

TEST(Solver, ScaleThatIsNoNumberOrZeroIsReported) {
  for (const Method method : kMethods) {
    for (const double bad : {kNaN, kInfinity, 0.0}) {
      Cvode solver(
          1, {1e-8, 0, method}, [](double, const double* y, double* rate) { rate[0] = -y[0]; }, {},
          [&](double t, const double*, double* scale) { scale[0] = t > 0.5 ? bad : 1; });
      std::array<double, 1> y{1};
      solver.start(0, y, 2);
      EXPECT_EQ(solver.advance(2, y).kind, Arrival::Kind::failed) << bad;
      EXPECT_TRUE(std::isnan(y[0]));
    }
    Cvode solver(
        1, {1e-8, 0, method}, [](double, const double* y, double* rate) { rate[0] = -y[0]; }, {},
        [](double, const double*, double*) { throw std::runtime_error("x"); });
    std::array<double, 1> y{1};
    solver.start(0, y, 2);
    EXPECT_THROW(solver.advance(2, y), std::runtime_error);
  }
}

TEST(Solver, StatisticsCountAllStarts) {
  for (const Method method : kMethods) {
    long calls = 0;
    Cvode solver(1, {1e-8, 1e-12, method}, [&](double, const double* y, double* rate) { ++calls, rate[0] = -y[0]; });
    std::array<double, 1> y{1};
    for (int i = 0; i < 5; ++i) {
      solver.start(0, y, 1);
      ASSERT_EQ(solver.advance(1, y).kind, Arrival::Kind::reached);
      EXPECT_EQ(solver.statistics().rhs_evaluations, calls);
      EXPECT_EQ(solver.statistics().restarts, i + 1);
    }
    EXPECT_NEAR(y[0], std::exp(-5.0), 1e-8);
  }
}

TEST(Solver, RightHandSideIsNeverAskedBeyondTheStop) {
  for (const Method method : kMethods) {
    double farthest = 0;
    const Outcome run = integrate(
        [&](double t, double y) {
          farthest = std::max(farthest, t);
          return -y;
        },
        2, method);
    EXPECT_EQ(run.arrival.kind, Arrival::Kind::reached);
    EXPECT_LE(farthest, 2);
  }
}

TEST(Solver, SaysNothingOnStandardError) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  integrate([](double, double y) { return y * y; }, 2, Method::adams);
  integrate([](double, double) { return kNaN; }, 2, Method::bdf);
  integrate(decay, 2, Method::bdf, 3);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace grainlaw::predict
