#include "model/vocabulary/portable.hpp"

#include <cmath>

namespace grainlaw::portable {
namespace {

/// hi + lo, |lo| at most half the last bit of hi.
struct Twofold {
  double hi = 0, lo = 0;
};

Twofold two_sum(double a, double b) {
  const double s = a + b, t = s - a;
  return {s, (a - (s - t)) + (b - t)};
}

Twofold two_product(double a, double b) {
  constexpr double kSplit = 134217729;  // 2^27 + 1
  const double p = a * b, ca = kSplit * a, cb = kSplit * b;
  const double a1 = ca - (ca - a), a2 = a - a1, b1 = cb - (cb - b), b2 = b - b1;
  return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
}

Twofold operator+(Twofold a, Twofold b) {
  const Twofold s = two_sum(a.hi, b.hi), t = two_sum(a.lo, b.lo);
  const Twofold u = two_sum(s.hi, s.lo + t.hi);
  return two_sum(u.hi, u.lo + t.lo);
}

Twofold operator-(Twofold a) { return {-a.hi, -a.lo}; }

Twofold operator*(Twofold a, Twofold b) {
  const Twofold p = two_product(a.hi, b.hi);
  return two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

Twofold operator/(Twofold a, double b) {
  const double q = a.hi / b;
  const Twofold rest = a + -two_product(q, b);
  return two_sum(q, (rest.hi + rest.lo) / b);
}

constexpr Twofold kOne{1, 0};
constexpr Twofold kLog2{0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
constexpr Twofold kHalfPi{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};

double rounded(Twofold a) { return a.hi + a.lo; }

/// e^x - 1, relative to itself for small x: Taylor at x/256, then (1 + y)^2 - 1 = y (2 + y) eight times.
Twofold expm1(Twofold x) {
  const double k = std::nearbyint(x.hi / kLog2.hi);
  const Twofold r = k == 0 ? x : x + -(kLog2 * Twofold{k, 0});
  const Twofold small{r.hi / 256, r.lo / 256};
  Twofold y, power = small;
  for (int n = 2; n <= 14; ++n) {
    y = y + power;
    power = power * small / n;
  }
  for (int n = 0; n < 8; ++n) y = y * (y + Twofold{2, 0});
  if (k == 0) return y;
  const Twofold all = y + kOne;
  const int exponent = static_cast<int>(k);
  return Twofold{std::ldexp(all.hi, exponent), std::ldexp(all.lo, exponent)} + -kOne;
}

/// sin and cos of x.
struct Circle {
  Twofold sin, cos;
};
Circle circle(Twofold x) {
  const double q = std::nearbyint(x.hi / kHalfPi.hi);
  const Twofold r = x + -(kHalfPi * Twofold{q, 0});
  Circle c{{}, kOne};
  Twofold power = r;  // r^n/n!
  for (int n = 1; n <= 28; ++n) {
    Twofold& sum = n % 2 == 1 ? c.sin : c.cos;
    sum = sum + (n / 2 % 2 == 1 ? -power : power);
    power = power * r / (n + 1);
  }
  const int turn = ((static_cast<int>(q) % 4) + 4) % 4;
  if (turn == 1) return {c.cos, -c.sin};
  if (turn == 2) return {-c.sin, -c.cos};
  if (turn == 3) return {-c.cos, c.sin};
  return c;
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

double sin(double x) { return rounded(circle({x, 0}).sin); }

double cos(double x) { return rounded(circle({x, 0}).cos); }

double acos(double x) {
  if (x == 1) return 0;
  const double y = std::acos(x);
  const Circle c = circle({y, 0});
  return rounded(Twofold{y, 0} + (c.cos + Twofold{-x, 0}) / rounded(c.sin));
}

double cbrt(double x) {
  if (x == 0) return x;
  const double y = std::cbrt(x);
  const Twofold square = two_product(y, y);
  return rounded(Twofold{y, 0} + (Twofold{x, 0} + -(square * Twofold{y, 0})) / (3 * square.hi));
}

}  // namespace grainlaw::portable
