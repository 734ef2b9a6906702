#pragma once
// What a reader sees before anything else: what was calibrated, whether it can be used, how far it is off, what it cost, what to
// distrust. Words follow from the numbers of chain/unseen_paths.hpp by the limits that stand here.

#include <string>
#include <vector>

#include "app/report/page.hpp"
#include "chain/unseen_paths.hpp"

namespace grainlaw::app::report {

/// Errors up to these are called good and rough, beyond poor; shares of the largest value [-].
inline constexpr double kGood = 0.10, kRough = 0.25;

/// Shade of an error in a heat map: up to 2.5, 5, 10, 25 %, and beyond; -1 without one.
int heat_of(double error);

/// A reason to distrust the result, the weightier the larger `weight`.
struct Reservation {
  double weight = 0;
  std::string words;
  std::string section;  ///< that has more
};

/// All that the data give reason for, weightiest first; never fewer than three.
std::vector<Reservation> reservations(const chain::ReportInput& input, const std::vector<chain::PathError>& errors);

/// Good for which kinds of path, rough or poor for which: by the recommended rung.
Paragraph verdict(const chain::ReportInput& input, const std::vector<chain::PathError>& errors);

/// Error of the recommended rung by kind of path; empty without any path.
Table errors_by_kind(const std::vector<chain::PathError>& errors);

std::vector<Block> first_screen(const chain::ReportInput& input, const std::vector<chain::PathError>& errors);

}  // namespace grainlaw::app::report
