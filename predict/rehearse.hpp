#pragma once
// The law along a path that no fit saw, against the runs of it: from the law's own start, row by row at the observed strains.
// One record of it is what CalibratedLaw::rehearsals holds. Formulas: docs/theory/bands.md, Rehearsals.

#include <array>
#include <string>
#include <vector>

#include "model/calibrated_law.hpp"
#include "model/vocabulary/run_control.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::predict {

/// Runs of one path on different packings.
struct RehearsalRuns {
  std::string name;
  std::vector<TestRecord> runs;
  bool fitted_packings = false;  ///< a run is on a packing whose other tests were fitted: its scatter is in the law too
};

/// One quantity at one row.
struct RehearsedValue {
  double weight = 0;                ///< w [-]
  double variance = 0;              ///< g.V g of the law there, in the unit of the quantity [-]
  double degrees_of_freedom = 0;    ///< of it; infinite where there is none
  double mean_variance = 0;         ///< sigma^2/n, what the mean of the runs owes to their scatter [-]
  std::vector<double> differences;  ///< of each run: DEM - law

  double mean_difference() const;
};

/// The rows that count, as in a comparison: of each the values of Rehearsed::P_star, s_par, F_par. Values that are undefined
/// have no differences.
using RehearsedRows = std::vector<std::array<RehearsedValue, 3>>;

/// `rung` of the law against the runs. Throws InvalidInput for runs that do not follow one path row by row; NotConverged;
/// Interrupted.
RehearsedRows rehearse(const CalibratedLaw& law, Rung rung, const RehearsalRuns& runs, const RunControl& control);

/// The record of a path over `rungs`; those that fail on it are left out and said in `failures`.
Rehearsal rehearsal_of(const CalibratedLaw& law, const std::vector<Rung>& rungs, const RehearsalRuns& runs,
                       const RunControl& control, std::vector<std::string>& failures);

/// Means over the rows.
RehearsedQuantity summary_of(const RehearsedRows& rows, Rehearsed quantity, bool fitted_packings);

}  // namespace grainlaw::predict
