#pragma once
// Where rehearsals come from: tests of role rehearsal in a data set, and data sets of runs of one path below its folder
// rehearsals/; and what a calibrated law makes of them.

#include <filesystem>
#include <string>
#include <vector>

#include "model/calibrated_law.hpp"
#include "model/files/dataset.hpp"
#include "model/files/execution.hpp"
#include "predict/rehearse.hpp"

namespace grainlaw::chain {

inline constexpr const char* kRehearsalsFolder = "rehearsals";  ///< beside dataset.json

/// Whether `test` is one of calibration on the packing, and whether `dataset` has one.
bool is_fitted(const PackingInfo& packing, const TestRecord& test);
bool is_fitted(const PackingInfo& packing, const Dataset& dataset);

/// The rehearsals of `dataset`, which was read in `folder`, by path. Throws InvalidInput for a folder below rehearsals/ whose
/// data set cannot be read or has a test of role calibration.
std::vector<predict::RehearsalRuns> rehearsals_of(const Dataset& dataset, const std::filesystem::path& folder);

/// Throws InvalidInput naming the first run below rehearsals/ of `folder` that is of another material than `packing`: packings
/// that are to take the place of the data set there.
void require_rehearsals_of(const PackingInfo& packing, const std::filesystem::path& folder);

/// The runs of `given`, the folder of a data set or of a prediction, by path; named after `name` where there is one path.
/// `dataset`: whose calibration tests tell which packings were fitted. Throws likewise.
std::vector<predict::RehearsalRuns> read_rehearsals(const std::filesystem::path& given, const std::string& name,
                                                    const Dataset* dataset);

inline constexpr const char* kRehearsalsOfBefore = "rehearsals-of-before";  ///< where others' are put aside

/// Copies the folders rehearsals/NAME from beside one data set to beside another, unless they are the same. Others that are there
/// are of the data set before; they are moved away, and where to is returned.
std::vector<std::string> adopt_rehearsals(const std::filesystem::path& from, const std::filesystem::path& to);

/// Sets `law.rehearsals`: every path by every rung that has its parameters. A path or a rung that fails is left out with a
/// warning.
void rehearse(CalibratedLaw& law, const std::vector<predict::RehearsalRuns>& paths, const Execution& execution);

/// Throws InvalidInput where `path` is rehearsed under another name, or the name is that of another path or none.
void check_rehearsal(const CalibratedLaw& law, const Path& path, const std::string& name);

/// Adds the runs in `given` as one more rehearsal to parameters.json, which is replaced whole, and as a data set to
/// dataset/rehearsals/`name` beside it, where a new calibration of that data set finds it. The same path of the same name is
/// replaced. Throws as check_rehearsal(), InvalidInput for runs of several paths, and NotConverged where every rung fails on it.
void add_rehearsal(const std::filesystem::path& parameters, const std::filesystem::path& given, const std::string& name,
                   const Execution& execution);

}  // namespace grainlaw::chain
