#pragma once
// The tables of the report: ours beside what Imole et al. (2013) published.

#include <string>

#include "app/report/table.hpp"
#include "chain/unseen_paths.hpp"

namespace grainlaw::app::report {

/// An estimate with its error, and its status in brackets where it is not fitted.
Cell estimate_cell(const Estimate& estimate);
/// Of `ours` from `reference` in percent.
Cell difference_cell(double ours, double reference);

/// Every parameter: meaning, symbol, equation, ours +- one standard error, 95 % interval, published, relative difference.
Table parameter_comparison(const CalibratedLaw& law);
/// Parameters with a value as bars with their intervals beside the published ones: jamming densities as they are, those with a
/// published value over it, others over their own.
enum class Forest { densities, ratios, own };
Table forest(const CalibratedLaw& law, Forest which);
/// What the parameters mean: C*, phi_r, P*, s_max, beta_s, F_max, beta_F at round densities of the calibrated range.
enum class CurveGroup { law, steady_state };
Table curve_comparison(const CalibratedLaw& law, CurveGroup which);
/// Every verdict on a parameter, or on a curve, mode by mode.
Table verdict_table(const std::vector<fit::Verdict>& verdicts, bool of_parameters);
/// What the paper says beyond Tables 2 and 3.
Table claim_table(const std::vector<fit::Claim>& claims);
/// nu_c of the modes, both ways.
Table jamming_table(const std::vector<fit::Verdict>& verdicts);
/// Stages of the fit: window, sizes, costs, termination.
Table stage_table(const fit::Calibration& calibration);
/// Misfit of the coupled fit per test and quantity.
Table residual_table(const fit::Calibration& calibration);
/// Leave-one-seed-out: largest shift and jackknife error of each parameter beside its stated error.
Table left_out_table(const fit::Calibration& calibration);
/// Likelihood profiles of the doubtful parameters.
Table profile_table(const fit::Calibration& calibration);
/// Detected onsets of the steady state, test by test.
Table steady_table(const fit::Calibration& calibration);
/// Error of each quantity by each rung on the predicted, or on the rehearsed, paths, as a heat map; predicted ones with the share
/// within the bands and links to the figures. `predictions` are those of `errors`.
Table unseen_table(const std::vector<chain::PathError>& errors, bool predicted,
                   const std::vector<predict::PredictionFolder>& predictions);
/// One prediction in full.
Table prediction_table(const predict::PredictionFolder& prediction);
/// Solver statistics of every curve.
Table solver_table(const std::vector<predict::PredictionFolder>& predictions);
/// Parameters of two laws, the difference in units of its error; and their errors on the unseen paths that both have.
Table parameter_pairs(const CalibratedLaw& ours, const CalibratedLaw& other);
Table error_pairs(const std::vector<chain::PathError>& ours, const std::vector<chain::PathError>& other);
/// Per run: seed, particles, rows, steps, seconds, largest energy ratio, energy residual and inertial number.
Table run_table(const chain::ReportInput& input);
/// Steps, particle-steps and seconds of the data set and of each prediction's runs.
Table cost_table(const chain::ReportInput& input);
/// Commands, versions and digests, and which files say so.
Table provenance_table(const chain::ReportInput& input);
Table spec_table(const chain::ReportInput& input);

/// Fixed-width text of parameter_comparison's first columns, for a terminal.
std::string parameter_summary(const CalibratedLaw& law);

}  // namespace grainlaw::app::report
