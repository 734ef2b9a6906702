#pragma once
// Elementary functions with the same bits on every machine. Those of a C library differ in the last one: it chooses by the
// processor's instructions, and libraries differ. These are made of + - * / and sqrt alone, whose rounding IEEE 754 fixes,
// in twice the precision: sums of two doubles (Dekker 1971), Taylor series, one step of Newton from the library's value
// where an inverse is wanted, which takes its last bit out. Correctly rounded unless the value lies within 2^-40 of its
// last bit from halfway between two doubles. A quarter to two thirds of a microsecond each.

namespace grainlaw::portable {

double exp(double x);    ///< |x| <= 700
double expm1(double x);  ///< |x| <= 700
double log(double x);    ///< x > 0, normal
double log1p(double x);  ///< x > -1
double sin(double x);    ///< |x| <= 100
double cos(double x);    ///< |x| <= 100
double acos(double x);   ///< |x| <= 1
double cbrt(double x);   ///< x normal, its cube root's cube as well

}  // namespace grainlaw::portable
