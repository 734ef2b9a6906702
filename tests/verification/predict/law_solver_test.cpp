// The solver when the right-hand side misbehaves (hard case O14): no call may end with a y that is not finite, at another
// t than asked, or wrong. dy/dt = -y with y_0 = 1 and faults sown at the n-th evaluation, for each n of a whole run.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "predict/solvers/cvode.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/not_finite.hpp"

namespace grainlaw::predict {
namespace {

using testing::expect_figure;

using testing::kInfinity;
using testing::kNaN;
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

/// What the calls of advance() may do, counted: arrive at the asked t with a finite y, end at an event, or say why not
/// and hold no y. Anything else is `otherwise`.
struct Tally {
  int arrived = 0, stopped = 0, reported = 0, otherwise = 0;

  void add(const Outcome& run, double t_asked) {
    const bool finite = std::isfinite(run.y);
    const Arrival& end = run.arrival;
    if (end.kind == Arrival::Kind::reached && finite && end.t == t_asked && end.message.empty())
      ++arrived;
    else if (end.kind == Arrival::Kind::event && finite && end.t >= 0 && end.t <= t_asked)
      ++stopped;
    else if (end.kind == Arrival::Kind::failed && std::isnan(run.y) && std::isfinite(end.t) && !end.message.empty())
      ++reported;
    else
      ++otherwise;
  }
};

TEST(Solver, O14OneFaultAtAnyEvaluationIsSurvivedOrReported) {
  Tally tally;
  double off = 0;
  for (const Method method : kMethods) {
    for (const double fault : {kNaN, kInfinity, -kInfinity}) {
      const long evaluations = integrate(decay, 2, method).statistics.rhs_evaluations;
      for (long n = 1; n <= evaluations; ++n) {
        long call = 0;
        const Outcome run = integrate([&](double, double y) { return ++call == n ? fault : -y; }, 2, method);
        tally.add(run, 2);
        if (run.arrival.kind == Arrival::Kind::reached) off = std::max(off, std::abs(run.y - std::exp(-2.0)));
      }
    }
  }
  EXPECT_GT(tally.arrived, 100) << "a smaller step gets round a single fault";
  EXPECT_GT(tally.reported, 0) << "but not at the first evaluation";
  expect_figure("O14.one_fault.otherwise", tally.otherwise, 0);
  expect_figure("O14.one_fault.error_over_rtol", off / 1e-8, 10);
}

TEST(Solver, O14LastingFaultsAreReported) {
  Tally tally;
  for (const Method method : kMethods) {
    for (const double from : {0.0, 1e-9, 0.5, 1.999}) {
      for (const double fault : {kNaN, kInfinity}) {
        const Outcome run = integrate([&](double t, double y) { return t >= from ? fault : -y; }, 2, method);
        tally.add(run, 2);
        EXPECT_EQ(run.arrival.kind, Arrival::Kind::failed) << "from t = " << from;
        EXPECT_LE(run.arrival.t, std::max(from, 1e-9));
      }
    }
    // Finite rates that overflow the state.
    tally.add(integrate([](double, double) { return std::numeric_limits<double>::max(); }, 2, method), 2);
    EXPECT_EQ(tally.arrived, 0);
  }
  expect_figure("O14.lasting_fault.otherwise", tally.otherwise, 0);
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
  Tally tally;
  double off = 0;
  for (const Method method : kMethods) {
    const long steps = integrate(decay, 2, method).statistics.steps;
    for (long limit = 1; limit <= steps + 1; ++limit) {
      const Outcome run = integrate(decay, 2, method, limit);
      tally.add(run, 2);
      if (run.arrival.kind == Arrival::Kind::reached) {
        off = std::max(off, std::abs(run.y - std::exp(-2.0)));
      } else {
        EXPECT_NE(run.arrival.message.find("mxstep"), std::string::npos) << run.arrival.message;
        EXPECT_LT(run.arrival.t, 2);
      }
    }
  }
  EXPECT_GT(tally.arrived, 1);
  EXPECT_GT(tally.reported, 50);
  expect_figure("O14.step_limit.otherwise", tally.otherwise, 0);
  expect_figure("O14.step_limit.error_over_rtol", off / 1e-8, 10);
}

TEST(Solver, O14VanishingStepIsReported) {
  Tally tally;
  for (const Method method : kMethods) {
    // dy/dt = y^2 has y = 1/(1 - t): no step leads past t = 1.
    const Outcome blow_up = integrate([](double, double y) { return y * y; }, 2, method);
    tally.add(blow_up, 2);
    EXPECT_NEAR(blow_up.arrival.t, 1, 1e-3);
    // A rate that jumps between +-1e20 from one evaluation to the next: no step is small enough.
    long call = 0;
    tally.add(integrate([&](double, double) { return ++call % 2 ? 1e20 : -1e20; }, 2, method), 2);
    EXPECT_EQ(tally.arrived, 0);
  }
  expect_figure("O14.vanishing_step.otherwise", tally.otherwise, 0);
}

TEST(Solver, O14IntervalsWithoutRoomForAStepAreWalkedOrReported) {
  // From t to t + d where d is down to one unit in the last place, or less: y is that of y_0 exp(-d) or nothing.
  Tally tally;
  double off = 0;
  for (const Method method : kMethods) {
    for (const double t_0 : {0.0, 1.0, 1e3}) {
      for (double d = 1e-6; d > 1e-20; d /= 4) {
        Cvode solver(1, {1e-8, 1e-12, method}, [](double, const double* y, double* rate) { rate[0] = -y[0]; });
        Outcome run;
        std::array<double, 1> y{1};
        const double t = t_0 + d;
        if (t == t_0) break;  // start() demands t_stop > t
        solver.start(t_0, y, t);
        run.arrival = solver.advance(t, y);
        run.y = y[0];
        tally.add(run, t);
        if (run.arrival.kind == Arrival::Kind::reached) off = std::max(off, std::abs(run.y - std::exp(t_0 - t)));
      }
    }
  }
  EXPECT_GT(tally.arrived, 50);
  EXPECT_GT(tally.reported, 3) << "the last ones are too close together";
  expect_figure("O14.short_interval.otherwise", tally.otherwise, 0);
  expect_figure("O14.short_interval.error_over_rtol", off / 1e-8, 10);
}

TEST(Solver, O14EventThatIsNoNumberIsReported) {
  // At the n-th evaluation of the event, once or from there on; without it the event lies at t = ln 2.
  Tally tally;
  double off = 0;
  for (const Method method : kMethods) {
    for (const double fault : {kNaN, kInfinity}) {
      for (const bool lasting : {false, true}) {
        for (int n = 1; n <= 60; ++n) {
          int call = 0;
          const Outcome run = integrate(decay, 2, method, 10000, [&](double, const double* y) {
            ++call;
            return call == n || (lasting && call > n) ? fault : y[0] - 0.5;
          });
          tally.add(run, 2);
          if (run.arrival.kind == Arrival::Kind::event) off = std::max(off, std::abs(run.arrival.t - std::log(2.0)));
        }
      }
    }
  }
  EXPECT_EQ(tally.arrived, 0) << "none runs past the event";
  EXPECT_GT(tally.reported, 100);
  expect_figure("O14.event_fault.otherwise", tally.otherwise, 0);
  expect_figure("O14.event_fault.place_over_rtol", off / 1e-8, 10);
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
