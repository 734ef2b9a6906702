#pragma once
// What the solvers share of the C library SUNDIALS, without a header of it: who owns what it creates, its context, its
// vector, and what CVODES and ARKODE call back (right-hand side, weights of the error norm, messages).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>

#include "model/vocabulary/error.hpp"
#include "predict/solvers/ode.hpp"

struct _SUNContext;  // the library's: what SUNContext and N_Vector point to
struct _generic_N_Vector;

namespace grainlaw::predict {

/// Calls `Free`, which takes the pointer.
template <auto Free>
struct Release {
  template <class Pointer>
  void operator()(Pointer pointer) const {
    Free(pointer);
  }
};

/// Owner of a SUNDIALS pointer type (SUNContext, N_Vector, void*).
template <class Pointer, auto Free>
using Owned = std::unique_ptr<std::remove_pointer_t<Pointer>, Release<Free>>;

/// Throws Error when the library had no memory for `what`.
template <class Pointer>
Pointer created(Pointer pointer, const char* what) {
  if (!pointer) throw Error(fmt::format("SUNDIALS: {} could not be created; is memory exhausted?", what));
  return pointer;
}

/// Of the context that every object of SUNDIALS belongs to; one per solver, so that threads share none.
void free_context(_SUNContext* context);
using OwnedContext = Owned<_SUNContext*, free_context>;

/// Throws Error when the library had no memory for it.
OwnedContext new_context();

/// SUNDIALS' serial vector of `size` zeros with the operations of its steppers in loops that the compiler vectorises: for a dozen
/// numbers the library's own cost as much as the law. Its clones have the same operations. The caller destroys it. Throws Error
/// without memory.
_generic_N_Vector* new_state_vector(std::size_t size, _SUNContext* context);

/// The libraries' user data.
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

  OdeCallbacks* user() { return this; }  ///< what the callbacks are given

  /// Throws Error unless a call of the library returned 0.
  void require(int flag, const char* call) const {
    if (flag != 0) throw Error(fmt::format("{} failed with flag {}: {}", call, flag, message));
  }

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
