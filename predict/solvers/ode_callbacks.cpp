#include "predict/solvers/ode_callbacks.hpp"

#include <nvector/nvector_serial.h>

#include <limits>

namespace grainlaw::predict {

int OdeCallbacks::evaluate_rate(double t, N_Vector y, N_Vector rate, void* user) {
  auto& self = *static_cast<OdeCallbacks*>(user);
  double* const out = N_VGetArrayPointer(rate);
  std::fill_n(out, self.size, std::numeric_limits<double>::quiet_NaN());
  return self.guarded(out, [&] { self.rate(t, N_VGetArrayPointer(y), out); });
}

int OdeCallbacks::evaluate_weights(N_Vector y, N_Vector weight, void* user) {
  auto& self = *static_cast<OdeCallbacks*>(user);
  double* const out = N_VGetArrayPointer(weight);
  const int flag = self.guarded(out, [&] { self.scale(self.time(), N_VGetArrayPointer(y), out); });
  if (flag != 0) return kGiveUp;
  for (std::size_t i = 0; i < self.size; ++i) out[i] = 1 / (self.relative * out[i] + self.absolute);
  return std::all_of(out, out + self.size, [](double v) { return v > 0 && std::isfinite(v); }) ? 0 : kGiveUp;
}

void OdeCallbacks::keep_message(int code, const char*, const char*, char* text, void* user) {
  auto& self = *static_cast<OdeCallbacks*>(user);
  self.message = text ? text : "";
  if (code > 0) self.warned = true;
}

}  // namespace grainlaw::predict
