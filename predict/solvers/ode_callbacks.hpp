#pragma once
// What the C libraries CVODES and ARKODE call back: right-hand side, weights of the error norm and messages, behind a
// header without SUNDIALS in it. The libraries' user data is an OdeCallbacks.

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <string>

#include "predict/solvers/cvode.hpp"

struct _generic_N_Vector;

namespace grainlaw::predict {

struct OdeCallbacks {
  static constexpr int kTryAgain = 1;  ///< recoverable: the solver reduces its step
  static constexpr int kGiveUp = -1;

  std::size_t size = 0;
  OdeRate rate;
  OdeScale scale;
  double relative = 0, absolute = 0;  ///< tolerances that the solver is given
  std::function<double()> time;       ///< where the solver is, which it does not tell the weights

  std::string message;        ///< what the library said last
  bool warned = false;        ///< whether it warned: of an integration there is one warning only, t + h == t
  std::exception_ptr thrown;  ///< by the user's functions; must not cross the C boundary

  /// The library's return value for `call`, which writes `size` numbers to `out`.
  template <class Call>
  int guarded(const double* out, Call&& call) {
    try {
      call();
    } catch (...) {
      thrown = std::current_exception();
      return kGiveUp;
    }
    return std::all_of(out, out + size, [](double v) { return std::isfinite(v); }) ? 0 : kTryAgain;
  }

  static int evaluate_rate(double t, _generic_N_Vector* y, _generic_N_Vector* rate, void* user);
  static int evaluate_weights(_generic_N_Vector* y, _generic_N_Vector* weight, void* user);
  static void keep_message(int code, const char* module, const char* function, char* text, void* user);
};

}  // namespace grainlaw::predict
