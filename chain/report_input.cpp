#include "chain/report_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "fit/calibration_file.hpp"
#include "model/files/digest.hpp"
#include "model/files/one_line.hpp"
#include "model/files/reading.hpp"
#include "model/parameters_file.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

void require_file(const fs::path& file, const std::string& command) {
  std::error_code ignored;
  if (fs::is_regular_file(file, ignored)) return;
  throw InvalidInput(fmt::format("{} is missing; make it with: {}", file.string(), command));
}

/// `read()`; what it refuses, a missing series for example, is answered with the command that makes it.
template <class Read>
auto with_remedy(const std::string& command, const Read& read) {
  try {
    return read();
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}; make it anew with: {}", error.what(), command));
  }
}

std::string calibrate_command(const fs::path& dir) {
  return fmt::format("grainlaw calibrate SPEC.json -o {}", dir.string());
}

/// Folders below `dir`, by name.
std::vector<fs::path> folders_of(const fs::path& dir) {
  std::vector<fs::path> folders;
  for (const fs::path& entry : entries_of(dir)) {
    if (fs::is_directory(entry)) folders.push_back(entry);
  }
  return folders;
}

/// Why there is no prediction, or what makes one.
std::string reason_for_none(const CalibratedLaw& law, const std::string& command) {
  try {
    require_parameters(law, Rung::reduced, "parameters.json");
  } catch (const InvalidInput& error) {
    return std::string("No prediction can be made: ") + error.what();
  }
  return fmt::format("No path that the fit never saw has been predicted. Make a prediction beside new runs with: {}",
                     command);
}

/// Those that compare settings; other studies have no figure here.
void add_studies(const fs::path& dir, ReportInput& input) {
  for (const fs::path& folder : folders_of(dir / "studies")) {
    const fs::path file = folder / "study.json";
    if (!fs::exists(file)) continue;
    const Json document = read_json(file, JsonSource::own);
    if (!document.is_object() || document.value("format", Json()) != "grainlaw study")
      throw InvalidInput(
          fmt::format("{}: is no study.json: its format must be \"grainlaw study\"; remove it", file.string()));
    try {
      if (document.contains("settings"))
        input.studies.emplace_back(folder.filename().string(), study_from_json(document));
    } catch (const Json::exception& error) {
      throw InvalidInput(fmt::format("{}: is no study.json: {}", file.string(), one_line(error.what(), 200)));
    }
  }
}

void add_dataset(Dataset dataset, const std::string& expected_digest, ReportInput& input) {
  if (!expected_digest.empty() && expected_digest != dataset.digest) {
    input.warnings.push_back(
        "parameters.json was fitted to another data set than the one in dataset/ (digests differ).");
  }
  input.provenance.push_back({"digest of the data set", dataset.digest, {"dataset/dataset.json"}});
  add_facts(dataset.provenance, "", "dataset/dataset.json", input.provenance);
  if (dataset.spec.is_object() &&
      dataset.spec.erase("coupling") > 0)  // of the data, which another law may be fitted to
    input.spec.push_back({"coupling", to_string(input.calibration.law.coupling), {"parameters.json"}});
  add_facts(dataset.spec, "", "dataset/dataset.json", input.spec);
  std::set<std::string> counted;  // both branches of a preparation are one run
  for (DatasetTest& test : dataset.tests) {
    if (!test.run.empty() && !counted.insert(test.run).second) test.cost = {};
    for (const std::string& warning : test.warnings) input.run_warnings.push_back(test.record.name + ": " + warning);
    input.costs.push_back(test.cost);
    input.tests.push_back(std::move(test.record));
  }
}

}  // namespace

ReportInput read_report_input(const fs::path& dir) {
  const std::string calibrate = calibrate_command(dir);
  require_file(dir / "dataset" / "dataset.json", calibrate);
  require_file(dir / "parameters.json", calibrate);
  require_file(dir / "calibration.json", calibrate);
  const std::string predict_into = fmt::format("grainlaw predict {} PATH.json --dem -o {}/",
                                               (dir / "parameters.json").string(), (dir / "predictions").string());

  ReportInput input;
  ParametersFile parameters = with_remedy(calibrate, [&] { return read_parameters(dir / "parameters.json"); });
  input.calibration.law = parameters.law;
  with_remedy(calibrate, [&] { input.modes = fit::read_calibration(dir / "calibration.json", input.calibration); });
  add_dataset(with_remedy(calibrate, [&] { return read_dataset(dir / "dataset"); }), parameters.law.dataset_digest,
              input);
  add_facts(parameters.provenance, "", "parameters.json", input.provenance);
  input.pictures = with_remedy(calibrate, [&] { return dem::read_pictures(dir / "dataset"); });
  input.calibrate_command =
      fmt::format("grainlaw calibrate --dataset {} -o {}", (dir / "dataset").string(), dir.string());
  input.fitted_paths =
      with_remedy(calibrate, [&] { return read_fitted_paths(dir / "fitted_paths.json", parameters.law); });

  add_studies(dir, input);
  const std::vector<fs::path> folders = folders_of(dir / "predictions");
  if (folders.empty()) input.no_predictions = reason_for_none(parameters.law, predict_into + "NAME");
  const std::string digest = sha256_of_file(dir / "parameters.json"), digest_of_law = law_digest(parameters.law);
  for (const fs::path& folder : folders) {
    const std::string name = folder.filename().string();
    require_file(folder / "prediction.json", predict_into + name);
    input.predictions.push_back(with_remedy(predict_into + name, [&] { return predict::read_prediction(folder); }));
    if (input.predictions.back().dem) {
      for (const DatasetTest& test : input.predictions.back().dem->tests) {
        for (const std::string& warning : test.warnings) {
          input.run_warnings.push_back(name + ", " + test.record.name + ": " + warning);
        }
      }
    }
    const Json& used = input.predictions.back().parameters;
    const bool same_file = !used.is_object() || used.value("sha256", digest) == digest;
    const bool same_law = same_file || used.value("law_sha256", "") == digest_of_law;
    if (!same_law) {
      input.warnings.push_back("predictions/" + name +
                               " was made with other parameters than those of parameters.json; it counts nowhere.");
      input.strange.insert(name);
    } else if (!same_file) {
      input.predictions.back().warnings.emplace_back("bands are those of before the last rehearsals; predict again");
    }
    add_facts(input.predictions.back().provenance, "", "predictions/" + name + "/prediction.json", input.provenance);
  }
  return input;
}

CalibratedLaw read_fitted_parameters(const fs::path& dir) {
  const std::string calibrate = calibrate_command(dir);
  require_file(dir / "parameters.json", calibrate);
  return with_remedy(calibrate, [&] { return read_parameters(dir / "parameters.json"); }).law;
}

std::vector<TestRecord> dem_records(const predict::PredictionFolder& prediction) {
  std::vector<TestRecord> records;
  if (prediction.dem) {
    for (const DatasetTest& test : prediction.dem->tests) records.push_back(test.record);
  }
  return records;
}

std::string fact_of(const ReportInput& input, const std::string& what, const std::string& file) {
  for (const Fact& fact : input.provenance) {
    if (fact.what == what && std::ranges::find(fact.files, file) != fact.files.end()) return fact.value;
  }
  return "";
}

std::vector<Misfit> coupled_misfits(const ReportInput& input) {
  std::vector<Misfit> misfits;
  for (const fit::Stage& stage : input.calibration.stages) {
    if (stage.name != "evolution") continue;
    for (const fit::TestResidual& residual : stage.tests) {
      for (const TestRecord& test : input.tests) {
        if (test.name == residual.test) misfits.push_back({residual, test});
      }
    }
  }
  return misfits;
}

void add_facts(const Json& document, const std::string& prefix, const std::string& file, std::vector<Fact>& facts) {
  if (document.is_null()) return;
  if (document.is_object()) {
    for (const auto& [key, value] : document.items()) {
      add_facts(value, prefix.empty() || prefix.back() == '.' ? prefix + key : prefix + "." + key, file, facts);
    }
    return;
  }
  // Seconds and megabytes with all their digits would drown the rest.
  const std::string value = document.is_string() ? document.get<std::string>()
                            : document.is_number_float()
                                ? fmt::format("{:.6g}", document.get<double>())
                                : document.dump(-1, ' ', false, Json::error_handler_t::replace);
  const auto known = std::find_if(facts.begin(), facts.end(),
                                  [&](const Fact& fact) { return fact.what == prefix && fact.value == value; });
  if (known != facts.end()) {
    known->files.push_back(file);
  } else {
    facts.push_back({prefix, value, {file}});
  }
}

}  // namespace grainlaw::chain
