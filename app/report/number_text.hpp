#pragma once
// Numbers as a reader wants them: few digits, never "nan". Independent of the locale.

#include <string>

namespace grainlaw::app::report {

/// What stands where there is no number.
inline constexpr const char* kNoNumber = "–";

/// `digits` significant digits, e.g. 0.04172, 1.23e-7, 1,200,000 as 1.2e+06; kNoNumber when not finite.
std::string significant(double value, int digits = 4);
/// Likewise with trailing zeros: 9.280.
std::string significant_padded(double value, int digits = 4);

/// Fixed number of decimals; kNoNumber when not finite.
std::string fixed(double value, int decimals);

/// "8.27 ± 0.31": error to two significant digits, value to the same decimal. Without a finite, positive error the
/// value alone with four significant digits.
std::string with_error(double value, double standard_error);
/// "lower … upper" of value -+ half_width, with the digits of the half width's leading two; empty when it is not finite.
std::string interval_text(double value, double half_width);

/// Relative difference of `ours` from `reference` as "+1.2 %"; kNoNumber when undefined.
std::string percent_difference(double ours, double reference);

/// "412 s", "12.3 min", "2.1 h".
std::string duration(double seconds);

}  // namespace grainlaw::app::report
