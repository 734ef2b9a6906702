#pragma once
// A data set on disk: FOLDER/dataset.json (spec, seeds, versions, digests, one entry for each test) and one
// FOLDER/NAME.csv for each test; FOLDER/probes/NAME.csv for those that were probed on their way.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "model/files/json_document.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw {

/// What the run behind a test took.
struct RunCost {
  std::uint64_t steps = 0;  ///< time steps
  double time_step = 0;     ///< dt [s]
  double seconds = 0;       ///< wall time [s]
};
constexpr auto fields_of(std::type_identity<RunCost>) {
  return std::tuple{Field{&RunCost::steps, "steps"}, Field{&RunCost::time_step, "time_step", "s"},
                    Field{&RunCost::seconds, "seconds", "s"}};
}
static_assert(tells_every_member<RunCost>());

struct DatasetTest {
  TestRecord record;
  std::string sha256;                 ///< of the CSV file
  std::string run;                    ///< key of the run that made it; empty when unknown
  RunCost cost;                       ///< zero when unknown
  std::vector<std::string> warnings;  ///< of the run
  std::string probes_sha256 = {};     ///< of probes/NAME.csv; empty without probes
};

inline constexpr const char* kProbesFolder = "probes";  ///< beside dataset.json

struct Dataset {
  std::vector<DatasetTest> tests;
  Json spec;  ///< resolved SPEC; null when unknown
  std::vector<std::uint64_t> seeds;
  Json provenance;     ///< of the maker; null when unknown
  std::string digest;  ///< SHA-256 over names, roles, paths, packings and CSV digests
};

/// Reads and checks everything. Throws InvalidInput naming file, key or row; digests that are given must match, and no
/// series may be both fitted and judged.
Dataset read_dataset(const std::filesystem::path& folder);

/// The records of one role.
std::vector<TestRecord> tests_of(const Dataset& dataset, Role role);

/// Writes dataset.json last; the CSV files must already be in `folder` (their digests are taken from there).
/// Sets digest, the tests' sha256 and, when empty, seeds.
void write_dataset_index(const std::filesystem::path& folder, Dataset& dataset);

// A data set that somebody else has made, taken into a folder of results so that the folder is complete:

/// `given` itself, or its dataset/ or dem/ when the folder of a calibration or of a prediction was given. Throws
/// InvalidInput when none of them holds a dataset.json.
std::filesystem::path dataset_folder(const std::filesystem::path& given);

/// Names of the series that the index in `folder` lists; none where there is none or it is damaged.
std::set<std::string> series_listed(const std::filesystem::path& folder);

/// Removes series and probes of those `listed` before that `dataset`, which has taken their place in `folder`, does not have.
void remove_stale_series(const std::filesystem::path& folder, const std::set<std::string>& listed,
                         const Dataset& dataset);

/// Copies the data set in `from`, as it was read, to `to`, in place of the one there, unless they are the same; returns what is
/// there.
Dataset adopt(const Dataset& dataset, const std::filesystem::path& from, const std::filesystem::path& to);

/// The data set of `digest`, to which the law in `parameters` was fitted, if it is beside that file as `calibrate` has left
/// it; where a law does not say which it was (an empty digest), the one that is there.
std::optional<Dataset> fitted_dataset(const std::filesystem::path& parameters, const std::string& digest);

/// Throws InvalidInput naming the first test of `runs`, the data set of `name`, that is to judge the law (validation,
/// rehearsal) and cannot: a test of role calibration in `fitted` is of another material or holds the same series.
void require_judges(const Dataset& runs, const Dataset& fitted, const std::string& name);

/// Throws InvalidInput naming the first test in the data set of `name` that does not follow `path`, or that was fitted.
void require_runs_of(const Path& path, const Dataset& dataset, const std::string& name);

}  // namespace grainlaw
