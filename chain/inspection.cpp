#include "chain/inspection.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

#include "chain/import/import.hpp"
#include "chain/report_input.hpp"
#include "dem/files/sphere_table.hpp"
#include "dem/files/state_file.hpp"
#include "fit/data/data_set.hpp"
#include "fit/prior_file.hpp"
#include "model/files/column.hpp"
#include "model/files/csv_table.hpp"
#include "model/files/one_line.hpp"
#include "model/files/schema.hpp"
#include "model/parameters_file.hpp"
#include "model/vocabulary/error.hpp"
#include "model/vocabulary/observation.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

/// What the others among the files say of a path.
struct Company {
  std::optional<dem::Spec> spec;
  fs::path parameters;
};

struct Kind {
  const char* name;
  Schema schema;
  const char* file;    ///< of the schema, without its ending
  const char* format;  ///< the document's own word for it; empty for those of users, which have none
};
constexpr std::array kKinds{Kind{"SPEC", Schema::spec, "spec", ""},
                            Kind{"TEST", Schema::test, "test", ""},
                            Kind{"PATH", Schema::path, "path", ""},
                            Kind{"data set", Schema::dataset, "dataset", "grainlaw dataset"},
                            Kind{"parameters", Schema::parameters, "parameters", "grainlaw parameters"},
                            Kind{"prior", Schema::prior, "prior", "grainlaw prior"},
                            Kind{"plan", Schema::plan, "plan", "grainlaw plan"},
                            Kind{"mapping", Schema::mapping, "import", ""}};

/// By its format, its "$schema", or else by the kind of which it has most keys.
const Kind* kind_of(const Json& document) {
  if (!document.is_object()) return nullptr;
  const std::string format = document.value("format", Json("")).is_string() ? document.value("format", "") : "";
  const std::string schema = document.value("$schema", Json("")).is_string() ? document.value("$schema", "") : "";
  const Kind* best = nullptr;
  std::size_t most = 0;
  for (const Kind& kind : kKinds) {
    if (!format.empty() && format == kind.format) return &kind;
    if (schema.ends_with(fmt::format("{}.schema.json", kind.file))) return &kind;
    std::size_t known = 0;
    const Json& properties = grainlaw::schema(kind.schema)["properties"];
    for (const auto& item : document.items()) known += properties.contains(item.key()) ? 1 : 0;
    const bool first_of_equals = best == nullptr || known > most;
    // a path of SPEC's defaults is a TEST, too: one that says nothing of a packing is a PATH
    const bool only_a_path = known == most && known > 0 && kind.schema == Schema::path;
    // what a SPEC and a TEST have in common is a SPEC, unless that alone would be wrong
    const bool only_a_test = known == most && known > 0 && kind.schema == Schema::test &&
                             !schema_violations(document, best->schema, "").empty() &&
                             schema_violations(document, Schema::test, "").empty();
    if (!first_of_equals && !only_a_path && !only_a_test) continue;
    best = &kind;
    most = known;
  }
  // tests of a SPEC have a mode or segments, those of a data set a path and a packing
  if (best->schema == Schema::spec && document.contains("tests") && document["tests"].is_array() &&
      !document["tests"].empty() && document["tests"][0].is_object() && document["tests"][0].contains("packing"))
    return &kKinds[3];
  return format.empty() ? best : nullptr;
}

std::string read_start(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string start(4096, '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  return start;
}

std::string counted(std::size_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

void inspect_spec(const fs::path& file, const fs::path& output, const Execution& execution, Inspection& seen) {
  const CalibrationInput input{dem::read_spec(file)};
  const dem::Spec& spec = *input.spec;
  seen.holds = {fmt::format("{} of {} spheres, {} on each", counted(spec.seeds.size(), "packing"),
                            spec.preparation.packing.particles,
                            counted(plan(spec).size() / spec.seeds.size(), "test"))};
  seen.forecast = forecast(input, output, execution);
  try {
    read_calibration_input(file, {});
  } catch (const InvalidInput& error) {  // studies of the engine take it all the same
    seen.forecast->fit_seconds = 0;
    seen.forecast->notes.push_back(fmt::format("calibrate refuses it: {}", error.what()));
  }
}

void inspect_test(const fs::path& file, const fs::path& output, const Execution& execution, Inspection& seen) {
  const dem::TestFile test = dem::read_test(file);
  seen.holds = {fmt::format(
      "{}, {}",
      test.given ? fmt::format("given packing of {} spheres", test.given->packing.size())
                 : fmt::format("packing of {} spheres, seed {}", test.preparation.packing.particles,
                               test.preparation.packing.seed),
      test.start == dem::Start::preparation ? "the preparation alone" : counted(test.path.segments.size(), "segment"))};
  seen.forecast = forecast(test, output, execution);
}

void inspect_path(const fs::path& file, const Company& company, const fs::path& output, const Execution& execution,
                  Inspection& seen) {
  const bool fitted = !company.parameters.empty();
  PredictionInput input{.law = {}, .law_file = company.parameters, .path = read_path(file), .path_name = file.string()};
  input.law.range = ValidRange{};
  if (fitted) input.law = read_parameters(company.parameters).law;
  if (company.spec && !law_decides(input.path.path))
    input.new_runs = fitted ? new_runs(input, *company.spec, {}, output) : NewRuns{*company.spec, {}, output};
  seen.holds = {fmt::format("{} from a volume fraction of {:.4g}", counted(input.path.path.segments.size(), "segment"),
                            input.path.path.nu)};
  for (const std::string& warning : input.path.warnings) seen.holds.push_back("warning: " + warning);
  if (fitted) check_prediction(input);
  seen.forecast = forecast(input, execution);
  if (input.new_runs) seen.holds.emplace_back("the runs below are those of predict --dem");
}

void inspect_dataset(const fs::path& folder, const fs::path& output, const Execution& execution, Inspection& seen) {
  const CalibrationInput input{{}, read_dataset(folder), folder};
  std::size_t rows = 0;
  for (const DatasetTest& test : input.dataset->tests) rows += test.record.rows.size();
  seen.holds = {fmt::format("{} on {}, {}", counted(input.dataset->tests.size(), "test"),
                            counted(input.dataset->seeds.size(), "packing"), counted(rows, "row"))};
  const std::vector<TestRecord> fitted = tests_of(*input.dataset, Role::calibration);
  if (fitted.empty()) {
    seen.holds.emplace_back("nothing in it is of role calibration: to be compared with, not to be fitted");
    return;
  }
  fit::check_and_sort(fitted);
  seen.forecast = forecast(input, output, execution);
}

void inspect_mapping(const fs::path& file, const Execution& execution, Inspection& seen) {
  const Mapping mapping = read_mapping(file);
  std::size_t rows = 0;
  std::vector<std::string> paths;
  std::vector<ImportedTest> tests;
  for (const ForeignTest& test : read_foreign(mapping, execution)) {
    const ImportedTest& ours = tests.emplace_back(imported(mapping, test));
    rows += ours.record.rows.size();
    paths.push_back(fmt::format("{}: {}", ours.record.name, ours.says.at(1)));
  }
  dataset_of(mapping, tests);
  const std::vector<std::string> doubts = suspicions(tests);
  seen.holds = {fmt::format("{} of others, {}", counted(mapping.tests.size(), "test"), counted(rows, "row"))};
  seen.holds.insert(seen.holds.end(), paths.begin(), paths.end());
  for (const std::string& doubt : doubts) seen.holds.push_back("warning: " + doubt);
}

void inspect_parameters(const fs::path& file, Inspection& seen) {
  const CalibratedLaw law = read_parameters(file).law;
  std::vector<std::string> rungs;
  for (const Rung rung : calibrated_rungs(law)) rungs.push_back(to_string(rung));
  seen.holds.push_back(fmt::format("law of coupling {}, rungs {}, {}", to_string(law.coupling),
                                   rungs.empty() ? "none" : fmt::format("{}", fmt::join(rungs, ", ")),
                                   counted(law.rehearsals.size(), "rehearsal")));
  seen.holds.push_back(fmt::format("calibrated at volume fractions {:.4g} to {:.4g}, deviatoric strain to {:.4g}",
                                   law.range.nu_min, law.range.nu_max, law.range.eps_dev_max));
  for (std::string& line : left_out_rungs(law)) seen.holds.push_back(std::move(line));
  if (!law.converged) seen.holds.emplace_back("its calibration did not converge");
}

void inspect_json(const fs::path& file, const Company& company, const fs::path& output, const Execution& execution,
                  Inspection& seen) {
  const Json document = read_json(file, JsonSource::any);  // who reads it then refuses what is a user's alone
  const Kind* kind = kind_of(document);
  if (kind == nullptr)
    throw InvalidInput(
        fmt::format("{}: no command reads this kind of file by itself; give a SPEC, TEST, PATH, data "
                    "set, parameters, prior, plan or mapping, or the folder of a calibration",
                    file.string()));
  seen.kind = kind->name;
  seen.refusals = schema_violations(document, kind->schema, one_line(file.string(), 200));
  if (!seen.refusals.empty()) return;
  switch (kind->schema) {
    case Schema::spec:
      return inspect_spec(file, output, execution, seen);
    case Schema::test:
      return inspect_test(file, output, execution, seen);
    case Schema::path:
      return inspect_path(file, company, output, execution, seen);
    case Schema::dataset:
      return inspect_dataset(file.has_parent_path() ? file.parent_path() : ".", output, execution, seen);
    case Schema::parameters:
      return inspect_parameters(file, seen);
    case Schema::mapping:
      return inspect_mapping(file, execution, seen);
    case Schema::prior:
      seen.holds = {counted(static_cast<std::size_t>(fit::read_prior(file).size.packings), "packing")};
      return;
    default:
      return;
  }
}

/// A table alone: titles, numbers. What a series says needs its path and packing, which its data set has.
void inspect_table(const fs::path& file, Inspection& seen) {
  const fs::path index = file.parent_path() / "dataset.json";
  CsvReader reader(file);
  const auto has = [&](const char* title) { return std::ranges::count(reader.header(), title) > 0; };
  std::vector<double> row;
  if (has("strain_xx")) {
    seen.kind = "series";
    if (has("stress_xx[Pa]")) matched<Observation>(reader);
    std::size_t rows = 0;
    while (reader.next(row)) ++rows;
    seen.holds = {fmt::format("{}{}", counted(rows, "row"),
                              has("stress_xx[Pa]") ? "" : ": strains alone, for strain_csv of PATH")};
    if (has("stress_xx[Pa]"))
      seen.holds.push_back(fs::exists(index) ? "what it says is judged with its data set: check " + index.string()
                                             : "what it says is judged with the dataset.json that lists it");
    return;
  }
  seen.kind = "spheres";
  const dem::State state = dem::read_spheres(file, 1e6 * Eigen::Matrix3d::Identity(), {});
  seen.holds = {fmt::format("{}; the cell is TEST's", counted(state.packing.size(), "sphere"))};
}

void inspect_folder(const fs::path& folder, const fs::path& output, const Execution& execution, Inspection& seen) {
  if (fs::exists(folder / "calibration.json")) {
    seen.kind = "calibration";
    const ReportInput input = read_report_input(folder);
    seen.holds = {
        fmt::format("{}, {}", counted(input.tests.size(), "test"), counted(input.predictions.size(), "prediction"))};
    for (const std::string& warning : input.warnings) seen.holds.push_back("warning: " + warning);
    return inspect_parameters(folder / "parameters.json", seen);
  }
  seen.kind = "data set";
  inspect_dataset(dataset_folder(folder), output, execution, seen);
}

Inspection inspected(const fs::path& file, const Company& company, const fs::path& output, const Execution& execution) {
  Inspection seen{file.string(), "", {}, {}};
  try {
    const bool folder = fs::is_directory(file);
    if (!folder && fs::exists(file) && !fs::is_regular_file(file))
      throw InvalidInput(
          fmt::format("{}: is no regular file, and check reads more than once; give a file", file.string()));
    const std::string start = folder ? "" : read_start(file);
    if (folder) {
      inspect_folder(file, output, execution, seen);
    } else if (start.starts_with(dem::kStateMagic)) {
      seen.kind = "state";
      const dem::State state = dem::read_state(file);
      seen.holds = {fmt::format("{} at a volume fraction of {:.6g}", counted(state.packing.size(), "sphere"),
                                dem::volume_fraction(state.packing))};
    } else if (file.extension() == ".csv") {
      inspect_table(file, seen);
    } else {
      inspect_json(file, company, output, execution, seen);
    }
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    seen.refusals.emplace_back(error.what());
  }
  return seen;
}

/// The first SPEC, or where none is given the spec beside the first parameters.json.
Company company_of(const std::vector<fs::path>& files) {
  Company company;
  for (const fs::path& given : files) {
    const fs::path file = fs::is_directory(given) ? given / "parameters.json" : given;
    try {
      if (!fs::is_regular_file(file) || file.extension() != ".json") continue;
      const Kind* kind = kind_of(read_json(file, JsonSource::any));
      if (kind != nullptr && kind->schema == Schema::spec && !company.spec) company.spec = dem::read_spec(file);
      if (kind == nullptr || kind->schema != Schema::parameters || !company.parameters.empty()) continue;
      read_parameters(file);
      company.parameters = file;
    } catch (const Error&) {
      continue;  // it is refused where it stands
    }
  }
  if (company.spec || company.parameters.empty()) return company;
  try {
    company.spec = spec_of_calibration({}, company.parameters);
  } catch (const Error&) {
    return company;  // nobody asked for it
  }
  return company;
}

}  // namespace

std::vector<Inspection> inspect(const std::vector<fs::path>& files, const fs::path& output,
                                const Execution& execution) {
  const Company company = company_of(files);
  std::vector<Inspection> all;
  for (const fs::path& file : files) all.push_back(inspected(file, company, output, execution));
  return all;
}

}  // namespace grainlaw::chain
