#include "model/vocabulary/portable.hpp"

#include <array>
#include <cmath>

namespace grainlaw::portable {
namespace {

/// hi + lo, |lo| at most half the last bit of hi.
struct Twofold {
  double hi = 0, lo = 0;
};

constexpr Twofold two_sum(double a, double b) {
  const double s = a + b, t = s - a;
  return {s, (a - (s - t)) + (b - t)};
}

constexpr Twofold two_product(double a, double b) {
  constexpr double kSplit = 134217729;  // 2^27 + 1
  const double p = a * b, ca = kSplit * a, cb = kSplit * b;
  const double a1 = ca - (ca - a), a2 = a - a1, b1 = cb - (cb - b), b2 = b - b1;
  return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
}

constexpr Twofold operator+(Twofold a, Twofold b) {
  const Twofold s = two_sum(a.hi, b.hi), t = two_sum(a.lo, b.lo);
  const Twofold u = two_sum(s.hi, s.lo + t.hi);
  return two_sum(u.hi, u.lo + t.lo);
}

constexpr Twofold operator-(Twofold a) { return {-a.hi, -a.lo}; }

constexpr Twofold operator*(Twofold a, Twofold b) {
  const Twofold p = two_product(a.hi, b.hi);
  return two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

constexpr Twofold operator/(Twofold a, double b) {
  const double q = a.hi / b;
  const Twofold rest = a + -two_product(q, b);
  return two_sum(q, (rest.hi + rest.lo) / b);
}

constexpr Twofold kOne{1, 0};
constexpr Twofold kLog2{0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
constexpr Twofold kHalfPi{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};

/// 1/n!, to where Taylor's series end.
constexpr auto kInverseFactorial = [] {
  std::array<Twofold, 29> inverse{kOne};
  for (std::size_t n = 1; n < inverse.size(); ++n) inverse[n] = inverse[n - 1] / static_cast<double>(n);
  return inverse;
}();

double rounded(Twofold a) { return a.hi + a.lo; }

/// The sum of x^j/(first + j step)! over j, as far as (first + j step) <= last, which it must reach.
Twofold series(Twofold x, std::size_t first, std::size_t step, std::size_t last) {
  Twofold sum = kInverseFactorial[last];
  for (std::size_t n = last; n > first; n -= step) sum = sum * x + kInverseFactorial[n - step];
  return sum;
}

/// e^x - 1, relative to itself for small x: Taylor at x/256, of which the term left out is below 2^-112 of the first, then
/// (1 + y)^2 - 1 = y (2 + y) eight times.
Twofold expm1(Twofold x) {
  const double k = std::nearbyint(x.hi / kLog2.hi);
  const Twofold r = k == 0 ? x : x + -(kLog2 * Twofold{k, 0});
  const Twofold small{r.hi / 256, r.lo / 256};
  Twofold y = small * series(small, 1, 1, 10);
  for (int n = 0; n < 8; ++n) y = y * (y + Twofold{2, 0});
  if (k == 0) return y;
  const Twofold all = y + kOne;
  const int exponent = static_cast<int>(k);
  return Twofold{std::ldexp(all.hi, exponent), std::ldexp(all.lo, exponent)} + -kOne;
}

/// sin(x + quarters pi/2): Taylor at most pi/4 from a multiple of pi/2.
Twofold sine(Twofold x, int quarters) {
  const double q = std::nearbyint(x.hi / kHalfPi.hi);
  const Twofold r = x + -(kHalfPi * Twofold{q, 0}), square = -(r * r);
  const int turn = (((static_cast<int>(q) + quarters) % 4) + 4) % 4;
  const Twofold value = turn % 2 == 0 ? r * series(square, 1, 2, 27) : series(square, 0, 2, 28);
  return turn < 2 ? value : -value;
}

}  // namespace

double expm1(double x) { return rounded(expm1(Twofold{x, 0})); }

double exp(double x) { return rounded(expm1(Twofold{x, 0}) + kOne); }

/// y + (1 + x) e^-y - 1, written so that little cancels.
double log1p(double x) {
  const double y = std::log1p(x);
  const Twofold back = expm1(Twofold{-y, 0});
  return rounded(Twofold{y, 0} + (Twofold{x, 0} + back + Twofold{x, 0} * back));
}

double log(double x) {
  if (x > 0.5 && x < 2) return log1p(x - 1);  // exact
  const double y = std::log(x);
  const Twofold power = expm1(Twofold{-y, 0}) + kOne;
  return rounded(Twofold{y, 0} + (Twofold{x, 0} * power + -kOne));
}

double sin(double x) { return rounded(sine({x, 0}, 0)); }

double cos(double x) { return rounded(sine({x, 0}, 1)); }

double acos(double x) {
  if (x == 1) return 0;
  const double y = std::acos(x);
  return rounded(Twofold{y, 0} + (sine({y, 0}, 1) + Twofold{-x, 0}) / rounded(sine({y, 0}, 0)));
}

double cbrt(double x) {
  if (x == 0) return x;
  const double y = std::cbrt(x);
  const Twofold square = two_product(y, y);
  return rounded(Twofold{y, 0} + (Twofold{x, 0} + -(square * Twofold{y, 0})) / (3 * square.hi));
}

}  // namespace grainlaw::portable
