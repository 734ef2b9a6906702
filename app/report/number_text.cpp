#include "app/report/number_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace grainlaw::app::report {
namespace {

/// A minus sign of the length of a digit instead of the hyphen.
std::string with_minus(std::string number) {
  for (std::size_t at = number.find('-'); at != std::string::npos; at = number.find('-', at)) {
    number.replace(at, 1, "\u2212");
  }
  return number;
}

}  // namespace

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return kNoNumber;
  return with_minus(fmt::format("{:.{}g}", value, digits));
}

std::string significant_padded(double value, int digits) {
  if (!std::isfinite(value) || value == 0) return significant(value, digits);
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  if (exponent < -5 || exponent > 8) return with_minus(fmt::format("{:.{}e}", value, digits - 1));
  return fixed(value, std::max(0, digits - 1 - exponent));
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return kNoNumber;
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find_first_of("123456789") == std::string::npos && text.front() == '-') text.erase(0, 1);
  return with_minus(text);
}

std::string with_error(double value, double standard_error) {
  if (!std::isfinite(value)) return kNoNumber;
  if (!(std::isfinite(standard_error) && standard_error > 0)) return significant(value);
  const double exponent = std::floor(std::log10(standard_error));
  if (exponent < -9 || exponent > 5) return significant(value) + " ± " + significant(standard_error, 2);
  const int decimals = std::max(0, 1 - static_cast<int>(exponent));
  return fixed(value, decimals) + " ± " + fixed(standard_error, decimals);
}

std::string interval_text(double value, double half_width) {
  if (!std::isfinite(value) || !(std::isfinite(half_width) && half_width > 0)) return "";
  const double exponent = std::floor(std::log10(half_width));
  if (exponent < -9 || exponent > 5) return significant(value - half_width) + " … " + significant(value + half_width);
  const int decimals = std::max(0, 1 - static_cast<int>(exponent));
  return fixed(value - half_width, decimals) + " … " + fixed(value + half_width, decimals);
}

std::string percent_difference(double ours, double reference) {
  const double percent = 100 * (ours - reference) / std::abs(reference);
  if (!std::isfinite(percent)) return kNoNumber;
  if (percent == 0) return "0\u00a0%";
  const int decimals = std::abs(percent) < 10 ? 1 : 0;
  return with_minus(fmt::format("{:+.{}f}\u00a0%", percent, decimals));
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds)) return kNoNumber;
  if (seconds < 100) return significant(seconds, 3) + " s";
  if (seconds < 6000) return fixed(seconds / 60, 1) + " min";
  return fixed(seconds / 3600, 1) + " h";
}

}  // namespace grainlaw::app::report
