#pragma once
// How far the law is off on paths that no fit saw: predictions beside DEM, and rehearsals, as one list.

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "chain/report_input.hpp"

namespace grainlaw::chain {

/// One rung on one path, from the law's own start where that was predicted, else from the measured one; arrays in the order of
/// Rehearsed.
struct PathError {
  std::string path;  ///< name of the prediction or the rehearsal, "(measured start)" behind it where it is from that
  const Path* along = nullptr;
  PathKind kind = PathKind::monotone;
  const predict::PredictionFolder* prediction = nullptr;  ///< none: a rehearsal
  Rung rung = Rung::reduced;
  bool recommended = false;  ///< for this path
  /// RMS over the largest value [-]: of a prediction by comparison.json, the largest of DEM; of a rehearsal by parameters.json, the
  /// largest that the law has on the path, to first order. NaN without a value.
  std::array<double, 3> error{kNone, kNone, kNone};
  std::array<double, 3> in_band{kNone, kNone, kNone};  ///< share of the rows of single runs within their 95 % band [-]

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
};

/// Predictions with runs first, then the rehearsals whose path is none of theirs; each rung that was compared and has a number.
/// Predictions by another law are left out. `input` must outlive the list.
std::vector<PathError> errors_on_unseen_paths(const ReportInput& input);

/// The error of a quantity over several paths.
struct ErrorOverPaths {
  int paths = 0;   ///< that have it
  double rms = 0;  ///< over the paths [-]
  double least = 0, largest = 0;
};

/// Over the entries that `keep` accepts.
template <class Keep>
ErrorOverPaths error_over(const std::vector<PathError>& errors, Rehearsed quantity, const Keep& keep) {
  ErrorOverPaths over;
  double square = 0;
  for (const PathError& entry : errors) {
    const double error = entry.error[static_cast<std::size_t>(quantity)];
    if (!(error >= 0) || !keep(entry)) continue;
    if (over.paths == 0 || error < over.least) over.least = error;
    if (over.paths == 0 || error > over.largest) over.largest = error;
    square += error * error;
    ++over.paths;
  }
  if (over.paths > 0) over.rms = std::sqrt(square / over.paths);
  return over;
}

}  // namespace grainlaw::chain
