#pragma once
// Whether bands hold on paths that neither the fit nor the bands saw: each rehearsal against the band that the others give
// (docs/theory/bands.md, Rehearsals).

#include <filesystem>
#include <string>
#include <vector>

#include "model/files/execution.hpp"
#include "model/rehearsals.hpp"

namespace grainlaw::chain {

/// One quantity by one rung on one path that was left out.
struct BandCoverage {
  std::string path;
  PathKind kind = PathKind::monotone;
  int packings = 0;
  Rung model = Rung::memory;
  Rehearsed quantity = Rehearsed::P_star;
  int rows = 0;
  bool of_kind = false;           ///< whether the others are of its kind, else all
  double degrees_of_freedom = 0;  ///< m, the others
  double tau = 0;                 ///< from the others [w]
  double bias = 0;                ///< mean of DEM - law [w]
  double bias_error = 0;  ///< of the packings and of the parameters, as if one along the path: standard error [w]
  double rms = 0;         ///< root mean square of it [w]
  double without = 0;     ///< share of rows whose mean of runs lies in the band without the law's own error
  double mean = 0;        ///< share of rows whose mean of runs lies in the band, its own error added
  double single = 0;      ///< share of rows of the runs in the band of a single run
  bool whole = false;     ///< whether the mean of the runs is nowhere beyond the largest deviation of the others
};
GRAINLAW_FIELDS(BandCoverage, path, kind, packings, model, quantity, rows, of_kind, degrees_of_freedom, tau, bias,
                bias_error, rms, without, mean, single, whole);

/// Over all paths of a rung and a quantity, each counted alike.
struct CoverageSummary {
  Rung model = Rung::memory;
  Rehearsed quantity = Rehearsed::P_star;
  int paths = 0;
  double without = 0, mean = 0, single = 0;  ///< means over the paths
  double least_mean = 1, least_single = 1;   ///< of the path with the fewest
  double whole = 0;                          ///< share of paths wholly within the band of whole curves
  double promised_whole = 0;                 ///< m/(m + 1), mean over the paths
};
GRAINLAW_FIELDS(CoverageSummary, model, quantity, paths, without, mean, single, least_mean, least_single, whole,
                promised_whole);

struct BandsStudy {
  std::string parameters;               ///< file
  std::vector<BandCoverage> coverages;  ///< by rung, path, quantity
  std::vector<CoverageSummary> summaries;
};

/// The rehearsals beside the data set of the calibration in `folder`, and the runs in `more` (folders of data sets or of
/// predictions), by its parameters.json. Throws InvalidInput where there are fewer than two paths.
BandsStudy study_bands(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& more,
                       const Execution& execution);

OrderedJson study_to_json(const BandsStudy& study);

}  // namespace grainlaw::chain
