#pragma once
// Everything that the report is drawn from, as read from the files of a calibration's folder. No numbers are made here.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "fit/calibrate.hpp"
#include "model/test_record.hpp"
#include "predict/compare.hpp"

namespace grainlaw::app::report {

/// A line "what: value" of the provenance table.
struct Fact {
  std::string what, value;
};

/// One test of the data set and what its run cost.
struct RunCost {
  std::string name;
  std::uint64_t steps = 0;   ///< time steps
  double time_step = 0;      ///< dt [s]
  double seconds = 0;        ///< wall time [s]
};

/// The law along the path, from one file.
struct PredictedCurve {
  std::string model;     ///< "reduced" or "evolution"
  std::string initial;   ///< "law" or "measured"
  std::string file;      ///< relative to the report's folder
  std::vector<predict::PredictedRow> rows;
  bool unjammed = false;
};

/// A comparison of one curve with one DEM run, or their mean.
struct ComparisonEntry {
  std::string model, initial;
  std::string test;      ///< name of the DEM series, or "mean"
  predict::QuantityComparison values;
};

struct PredictionCase {
  std::string name;      ///< folder below predictions/
  Path path;
  std::vector<PredictedCurve> curves;
  std::vector<TestRecord> dem;          ///< empty when the prediction was made without --dem
  std::vector<std::string> dem_files;   ///< relative to the report's folder
  std::vector<ComparisonEntry> comparisons;
  std::vector<std::string> warnings;
};

struct ReportInput {
  std::vector<TestRecord> tests;        ///< data set, calibration and validation
  fit::Calibration calibration;
  std::vector<PredictionCase> predictions;
  std::vector<Fact> provenance;
  std::vector<RunCost> costs;
};

/// Reads `folder`. A missing file is an Error that names the command which makes it.
ReportInput read_report_input(const std::filesystem::path& folder);

}  // namespace grainlaw::app::report
