#pragma once
// Everything that the report is drawn from, as read from the files of a calibration's folder. No numbers are made here.

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "chain/fitted_paths.hpp"
#include "chain/studies/settings_study.hpp"
#include "dem/runs/pictures.hpp"
#include "fit/calibrate.hpp"
#include "fit/published/verdicts.hpp"
#include "model/vocabulary/test_record.hpp"
#include "predict/prediction_files.hpp"

namespace grainlaw::chain {

/// A line "what: value" of the provenance table, and the files that say so.
struct Fact {
  std::string what, value;
  std::vector<std::string> files;
};

struct ReportInput {
  std::vector<TestRecord> tests;  ///< data set, calibration and validation
  std::vector<RunCost> costs;     ///< of the tests, in their order
  fit::Calibration calibration;
  fit::ModeComparison modes;                           ///< beside what was published
  std::vector<predict::PredictionFolder> predictions;  ///< by name
  std::set<std::string> strange;         ///< predictions by another law, which say nothing of this one
  std::string no_predictions;            ///< why there are none, or the command that makes them; else empty
  std::vector<FittedPath> fitted_paths;  ///< the law along the shear tests
  std::vector<std::pair<std::string, SettingsStudy>>
      studies;                            ///< of studies/NAME/study.json that compare settings, by name
  std::string calibrate_command;          ///< that makes the folder's files anew from its data set
  std::optional<dem::ShearPictures> pictures;  ///< of one packing; older data sets have none
  std::vector<Fact> provenance;           ///< commands, versions, seconds
  std::vector<Fact> spec;                 ///< of the data set, resolved; empty when unknown
  std::vector<std::string> warnings;      ///< files that do not belong together
  std::vector<std::string> run_warnings;  ///< "test: warning" of the DEM runs
};

/// Reads the folder `dir` of a calibration. A missing file is InvalidInput that names the command which makes it; predictions
/// may be missing, and what earlier programs did not write.
ReportInput read_report_input(const std::filesystem::path& dir);

/// parameters.json alone, as far as the table of parameters goes. Throws likewise.
CalibratedLaw read_fitted_parameters(const std::filesystem::path& dir);

/// The DEM runs of a prediction; empty when it was made without --dem.
std::vector<TestRecord> dem_records(const predict::PredictionFolder& prediction);

/// Value of the provenance's line `what` as `file` says it; empty without.
std::string fact_of(const ReportInput& input, const std::string& what, const std::string& file);

/// A residual of the coupled fit and the test that it is of.
struct Misfit {
  const fit::TestResidual& residual;
  const TestRecord& test;
};
std::vector<Misfit> coupled_misfits(const ReportInput& input);

/// `document` as lines "outer.inner: value", arrays on one line, null left out. A line that is there already only
/// gains a file.
void add_facts(const Json& document, const std::string& prefix, const std::string& file, std::vector<Fact>& facts);

}  // namespace grainlaw::chain
