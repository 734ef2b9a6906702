#include "predict/solvers/runge_kutta.hpp"

#include <arkode/arkode_erkstep.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/vocabulary/error.hpp"
#include "predict/solvers/sundials.hpp"

namespace grainlaw::predict {
namespace {

ARKODE_ERKTableID table_of(int order) {
  switch (order) {
    case 2:
      return ARKODE_HEUN_EULER_2_1_2;
    case 3:
      return ARKODE_BOGACKI_SHAMPINE_4_2_3;
    case 4:
      return ARKODE_ZONNEVELD_5_3_4;
    case 5:
      return ARKODE_DORMAND_PRINCE_7_4_5;
    case 6:
      return ARKODE_VERNER_8_5_6;
    case 8:
      return ARKODE_FEHLBERG_13_7_8;
    default:
      throw InvalidInput(fmt::format("explicit Runge-Kutta of order {}: give 2, 3, 4, 5, 6 or 8", order));
  }
}

}  // namespace

struct RungeKutta::Impl : OdeCallbacks {
  OwnedContext context = new_context();
  Owned<N_Vector, N_VDestroy> y;
  static void release(void* memory) { ERKStepFree(&memory); }
  Owned<void*, release> memory;
  long rhs_evaluations = 0, steps = 0;
};

RungeKutta::RungeKutta(std::size_t size, int order, double relative, double absolute, long max_steps, OdeRate rate,
                       OdeScale scale)
    : impl_(std::make_unique<Impl>()) {
  Impl& self = *impl_;
  const ARKODE_ERKTableID table = table_of(order);
  self.size = size;
  self.rate = std::move(rate);
  self.scale = std::move(scale);
  self.time = [&self] {
    double t = 0;
    ERKStepGetCurrentTime(self.memory.get(), &t);
    return t;
  };
  self.relative = relative;
  self.absolute = absolute;
  self.y.reset(new_state_vector(size, self.context.get()));
  self.memory.reset(
      created(ERKStepCreate(Impl::evaluate_rate, 0, self.y.get(), self.context.get()), "the memory of ARKODE"));
  void* const memory = self.memory.get();
  self.require(ERKStepSetErrHandlerFn(memory, Impl::keep_message, self.user()), "ERKStepSetErrHandlerFn");
  self.require(ERKStepSetUserData(memory, self.user()), "ERKStepSetUserData");
  self.require(ERKStepSetTableNum(memory, table), "ERKStepSetTableNum");
  self.require(ERKStepWFtolerances(memory, Impl::evaluate_weights), "ERKStepWFtolerances");
  self.require(ERKStepSetMaxNumSteps(memory, max_steps), "ERKStepSetMaxNumSteps");
}

RungeKutta::~RungeKutta() = default;

Arrival RungeKutta::integrate(double t, std::span<double> y, double t_end) {
  Impl& self = *impl_;
  void* const memory = self.memory.get();
  double* const state = N_VGetArrayPointer(self.y.get());
  std::copy(y.begin(), y.end(), state);
  self.message.clear();
  self.thrown = nullptr;
  self.require(ERKStepReInit(memory, Impl::evaluate_rate, t, self.y.get()), "ERKStepReInit");
  self.require(ERKStepSetStopTime(memory, t_end), "ERKStepSetStopTime");
  std::fill(y.begin(), y.end(), std::numeric_limits<double>::quiet_NaN());

  double reached = std::numeric_limits<double>::quiet_NaN();
  const int flag = ERKStepEvolve(memory, t_end, self.y.get(), &reached, ARK_NORMAL);
  if (self.thrown) std::rethrow_exception(self.thrown);
  long evaluations = 0, attempts = 0;
  ERKStepGetNumRhsEvals(memory, &evaluations);
  ERKStepGetNumStepAttempts(memory, &attempts);
  self.rhs_evaluations += evaluations;
  self.steps += attempts;

  const bool finite = std::all_of(state, state + self.size, [](double v) { return std::isfinite(v); });
  if (flag < 0 || !finite || reached != t_end) {
    return {Arrival::Kind::failed, std::isfinite(reached) ? reached : t,
            self.message.empty() ? fmt::format("ARKODE returned {} at t = {} instead of {}", flag, reached, t_end)
                                 : self.message};
  }
  std::copy_n(state, self.size, y.begin());
  return {Arrival::Kind::reached, reached, {}};
}

long RungeKutta::rhs_evaluations() const { return impl_->rhs_evaluations; }
long RungeKutta::steps() const { return impl_->steps; }

}  // namespace grainlaw::predict
