#include "predict/solvers/sundials.hpp"

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <limits>

// Of the loop after it: no element that it writes is read by another turn.
#if defined(__clang__)
#define GRAINLAW_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define GRAINLAW_INDEPENDENT _Pragma("GCC ivdep")
#endif

namespace grainlaw::predict {
namespace {

constexpr int kMostTerms = 13;  // Fehlberg's stages; more are left to the library

double* data(N_Vector v) { return NV_DATA_S(v); }
sunindextype length(N_Vector v) { return NV_LENGTH_S(v); }

/// z = a x + b y. Any of them may be the same vector.
void linear_sum(double a, N_Vector x, double b, N_Vector y, N_Vector z) {
  const double *X = data(x), *Y = data(y);
  double* Z = data(z);
  const sunindextype n = length(z);
  GRAINLAW_INDEPENDENT
  for (sunindextype i = 0; i < n; ++i) Z[i] = a * X[i] + b * Y[i];
}

void scale(double c, N_Vector x, N_Vector z) {
  const double* X = data(x);
  double* Z = data(z);
  const sunindextype n = length(z);
  GRAINLAW_INDEPENDENT
  for (sunindextype i = 0; i < n; ++i) Z[i] = c * X[i];
}

double weighted_rms(N_Vector x, N_Vector w) {
  const double *X = data(x), *W = data(w);
  const sunindextype n = length(x);
  double sum = 0;
  for (sunindextype i = 0; i < n; ++i) sum += (X[i] * W[i]) * (X[i] * W[i]);
  return std::sqrt(sum / static_cast<double>(n));
}

/// z = sum of c_k x_k for exactly `terms` of them, read through once; z may be one of them.
template <int terms>
void combine(const double* c, const double* const* X, double* Z, sunindextype n) {
  GRAINLAW_INDEPENDENT
  for (sunindextype i = 0; i < n; ++i) {
    double sum = c[0] * X[0][i];
    for (int k = 1; k < terms; ++k) sum += c[k] * X[k][i];
    Z[i] = sum;
  }
}

template <int terms>
int combine_up_to(int count, const double* c, const double* const* X, double* Z, sunindextype n) {
  if constexpr (terms > 1) {
    if (count < terms) return combine_up_to<terms - 1>(count, c, X, Z, n);
  }
  combine<terms>(c, X, Z, n);
  return 0;
}

int linear_combination(int count, double* c, N_Vector* x, N_Vector z) {
  if (count < 1 || count > kMostTerms) return N_VLinearCombination_Serial(count, c, x, z);
  const double* X[kMostTerms] = {};
  for (int k = 0; k < count; ++k) X[k] = data(x[k]);
  return combine_up_to<kMostTerms>(count, c, X, data(z), length(z));
}

/// z_k = a_k x + y_k, the prediction of a multistep method.
int scale_add_multi(int count, double* a, N_Vector x, N_Vector* y, N_Vector* z) {
  for (int k = 0; k < count; ++k) linear_sum(a[k], x, 1, y[k], z[k]);
  return 0;
}

}  // namespace

void free_context(SUNContext context) { SUNContext_Free(&context); }

OwnedContext new_context() {
  SUNContext context = nullptr;
  SUNContext_Create(nullptr, &context);
  return OwnedContext{created(context, "a context")};
}

_generic_N_Vector* new_state_vector(std::size_t size, _SUNContext* context) {
  N_Vector v = created(N_VNew_Serial(static_cast<sunindextype>(size), context), "the state vector");
  N_VConst(0, v);
  v->ops->nvlinearsum = linear_sum;
  v->ops->nvscale = scale;
  v->ops->nvwrmsnorm = weighted_rms;
  v->ops->nvlinearcombination = linear_combination;
  v->ops->nvscaleaddmulti = scale_add_multi;
  return v;
}

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
