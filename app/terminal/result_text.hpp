#pragma once
// What the commands say on standard output of their results: text for people, JSON for programs.

#include <filesystem>
#include <string>

#include "app/terminal/session.hpp"
#include "chain/calibration.hpp"
#include "chain/planning/target_calibration.hpp"
#include "dem/runs/simulation.hpp"
#include "predict/prediction_files.hpp"

namespace grainlaw::app {

/// The end of the series, and where everything is.
std::string text_of(const dem::SimulationResult& simulation, const std::filesystem::path& output);

/// The report's table, runs, seconds and memory.
std::string text_of(const chain::CalibrationResult& result, const std::filesystem::path& output,
                    const Session& session);
OrderedJson summary_of(const chain::CalibrationResult& result, const std::filesystem::path& output,
                       const Session& session);

/// A line for each round of the plan.
std::string text_of(const chain::TargetCalibration& calibration, const chain::PrecisionTarget& target,
                    const std::filesystem::path& output);

/// The rung that the path needs and the one that is recommended, whose curve comes first; the end of each curve with its
/// bands, and how far runs are from it.
std::string text_of(const predict::PredictionFolder& prediction, const std::filesystem::path& output);
OrderedJson summary_of(const predict::PredictionFolder& prediction, const std::filesystem::path& output);

}  // namespace grainlaw::app
