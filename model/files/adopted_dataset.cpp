#include "model/files/adopted_dataset.hpp"

#include <fmt/format.h>

#include <cmath>

#include "model/files/path_json.hpp"
#include "model/files/output_folder.hpp"
#include "model/files/durable_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {

namespace fs = std::filesystem;

fs::path dataset_folder(const fs::path& given) {
  for (const fs::path& folder : {given, given / "dataset", given / "dem"}) {
    if (fs::exists(folder / "dataset.json")) return folder;
  }
  throw InvalidInput(fmt::format("{}: holds no dataset.json; give the folder of a data set", given.string()));
}

Dataset adopt(const Dataset& dataset, const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (fs::equivalent(from, to, error)) return dataset;
  for (const DatasetTest& test : dataset.tests) {
    const std::string file = test.record.name + ".csv";
    copy_durably(from / file, to / file);
    if (!test.probes_sha256.empty())
      copy_durably(from / kProbesFolder / file, make_subfolder(to, kProbesFolder) / file);
  }
  copy_durably(from / "dataset.json", to / "dataset.json");
  return read_dataset(to);
}

void require_runs_of(const Path& path, const Dataset& dataset, const std::string& name) {
  for (const DatasetTest& test : dataset.tests) {
    const TestRecord& record = test.record;
    if (record.role == Role::calibration) {
      throw InvalidInput(
          fmt::format("{}: test {} is of role calibration; a prediction is compared with runs that no fit "
                      "has seen",
                      name, record.name));
    }
    if (path_to_json(record.path) != path_to_json(path)) {
      throw InvalidInput(fmt::format("{}: test {} follows another path ({}); give runs of the predicted path", name,
                                     record.name, path_to_json(record.path).dump()));
    }
  }
}

}  // namespace grainlaw
