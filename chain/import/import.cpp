#include "chain/import/import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "chain/import/particles.hpp"
#include "chain/import/series.hpp"
#include "chain/import/straight_path.hpp"
#include "model/files/column.hpp"
#include "model/files/csv_table.hpp"
#include "model/files/digest.hpp"
#include "model/files/output.hpp"
#include "model/files/series_csv.hpp"
#include "model/vocabulary/error.hpp"
#include "model/vocabulary/series_check.hpp"

namespace grainlaw::chain {
namespace {

namespace fs = std::filesystem;

constexpr double kAtCorner = 1e-9;  // strain; a row that ends its segment was moved onto the corner

void check_times(const ForeignRows& foreign) {
  for (std::size_t i = 1; i < foreign.rows.size(); ++i) {
    const double before = foreign.rows[i - 1].time, here = foreign.rows[i].time;
    if (std::isnan(before) && std::isnan(here)) continue;
    if (!(here > before))
      throw InvalidInput(
          fmt::format("{}: the time {} does not grow from {} of the row before; sort the rows, keep one of equals",
                      foreign.place(i, "time"), here, before));
  }
}

Path path_of(const Mapping& mapping, const TestMapping& test, const ForeignRows& foreign) {
  Path path{test.nu.value_or(foreign.rows.front().nu), test.branch, test.segments};
  try {
    if (path.segments.empty()) path.segments = found_segments(foreign.rows, test.path_tolerance);
    check(path);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: test {}: path: {}", mapping.name, test.name, error.what()));
  }
  return path;
}

/// Each segment starts from the row that ends the one before it, so there must be one at each corner.
void check_corners(const ForeignRows& foreign, const TestRecord& record) {
  const std::vector<StraightSegment> segments = resolve(record.path);
  for (std::size_t i = 1; i < record.rows.size(); ++i) {
    const Observation &last = record.rows[i - 1], &next = record.rows[i];
    if (next.segment == last.segment) continue;
    const Eigen::Matrix3d corner = segments[static_cast<std::size_t>(next.segment)].strain_start.tensor;
    const double before = (last.strain.tensor - corner).norm();
    if (before > kAtCorner)
      throw InvalidInput(
          fmt::format("{}: is the last row of segment {} of the path, {:.3g} of strain before its end; keep the row at "
                      "each corner, "
                      "correct the path, or leave it out to have it found",
                      foreign.place(i - 1, "strain"), last.segment, before));
  }
}

void check_finite(const ForeignRows& foreign, const std::vector<Observation>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (const auto* column = infinite_column(rows[i]))
      throw InvalidInput(fmt::format("{}: {} becomes infinite; are the units and the packing's numbers right?",
                                     foreign.place(i, column->name), column->name));
  }
}

/// Titles of extra columns fit for the header of a CSV, all different.
std::string extra_text(const ExtraColumns& extra) {
  std::set<std::string> titles;
  std::string text = "row";
  for (std::string title : extra.titles) {
    for (char& c : title) {
      if (c == ',' || c == '"' || static_cast<unsigned char>(c) < ' ') c = '_';
    }
    while (!titles.insert(title).second) title += '_';
    text += "," + title;
  }
  text += '\n';
  for (std::size_t i = 0; i < extra.rows.size(); ++i) {
    text += std::to_string(i + 1);
    for (const double value : extra.rows[i]) text += "," + csv_number(value);
    text += '\n';
  }
  return text;
}

/// Refuses a folder in which what is imported would be overwritten.
void check_output(const std::vector<ForeignTest>& foreign, const fs::path& output) {
  std::error_code absent;
  for (const ForeignTest& test : foreign) {
    if (!test.mapping.series) continue;
    const fs::path file = test.mapping.series->file, folder = file.has_parent_path() ? file.parent_path() : ".";
    if (fs::equivalent(folder, output, absent))
      throw InvalidInput(
          fmt::format("{}: holds the tables that are imported, {} among them; give another folder with -o",
                      output.string(), file.filename().string()));
  }
}

/// A series that an earlier import left under the name must not stay beside an index that does not know it.
void remove_extra(const fs::path& output, const std::string& name) { fs::remove(output / (name + ".extra.csv")); }

}  // namespace

std::vector<ForeignTest> read_foreign(const Mapping& mapping, const Execution& execution) {
  std::vector<ForeignTest> tests;
  for (const TestMapping& test : mapping.tests) {
    if (execution.stop.stop_requested()) throw Interrupted("interrupted; nothing was written");
    tests.push_back({test, test.series ? read_series(mapping, test)
                                       : read_particle_rows(mapping, test, {.report = {}, .stop = execution.stop})});
  }
  return tests;
}

ImportedTest imported(const Mapping& mapping, const ForeignTest& test) {
  const ForeignRows& foreign = test.foreign;
  ImportedTest result;
  TestRecord& record = result.record;
  record.name = test.mapping.name;
  record.role = test.mapping.role;
  record.packing = foreign.packing.value_or(test.mapping.packing.value_or(PackingInfo{}));
  record.rows = foreign.rows;
  check_times(foreign);
  record.path = path_of(mapping, test.mapping, foreign);
  complete(record.rows, record.path, record.packing);
  check_contradictions(record.rows, record.path, record.packing, foreign.place);  // of what was given
  const Moved moved = move_onto(record.path, test.mapping.path_tolerance, record.rows);
  if (moved.farthest > test.mapping.path_tolerance)
    throw InvalidInput(fmt::format(
        "{}: the strain is {:.3g} off {}, more than path_tolerance, {:g}; correct the path, or leave it "
        "out to have it found, or allow more",
        foreign.place(moved.row, "strain"), moved.farthest, path_text(record.path), test.mapping.path_tolerance));
  check_corners(foreign, record);
  complete(record.rows, record.path, record.packing);
  check_series(record.rows, record.path, record.packing, foreign.place);
  check_finite(foreign, record.rows);
  result.says = {
      fmt::format("{} rows", record.rows.size()),
      fmt::format("path {} {}", test.mapping.segments.empty() ? "found" : "given", path_text(record.path)),
      fmt::format("rows moved onto it by {:.2g} at most, tolerance {:g}", moved.farthest, test.mapping.path_tolerance)};
  result.provenance = foreign.provenance;
  result.provenance["path"] = {{"given", !test.mapping.segments.empty()},
                               {"tolerance", test.mapping.path_tolerance},
                               {"farthest_row", moved.farthest}};
  if (!foreign.extra.titles.empty()) result.provenance["extra"] = record.name + ".extra.csv";
  return result;
}

std::vector<std::string> suspicions(const std::vector<ImportedTest>& tests) {
  constexpr double kFarOff = 30, kTelling = 1e-3, kNear = 2e-3;  // ratio; P*; distance in nu
  std::vector<std::string> all;
  for (const ImportedTest& of : tests) {
    for (const ImportedTest& unloading : tests) {
      if (!is_isotropic_unloading(unloading.record) || is_isotropic_unloading(of.record) ||
          of.record.packing.seed != unloading.record.packing.seed)
        continue;
      const Observation& start = of.record.rows.front();
      const auto nearest = std::ranges::min_element(
          unloading.record.rows, {}, [&](const Observation& row) { return std::abs(row.nu - start.nu); });
      const double more = std::max(nearest->P_star, start.P_star), less = std::min(nearest->P_star, start.P_star);
      if (std::abs(nearest->nu - start.nu) > kNear || more < kTelling || less * kFarOff > more) continue;
      all.push_back(fmt::format(
          "test {} starts at P* = {:.3g}, where {} of the same packing has {:.3g}: are the units of both right?",
          of.record.name, start.P_star, unloading.record.name, nearest->P_star));
    }
  }
  return all;
}

Dataset dataset_of(const Mapping& mapping, const std::vector<ImportedTest>& tests) {
  Dataset dataset;
  for (const ImportedTest& test : tests) {
    dataset.tests.push_back({.record = test.record,
                             .sha256 = sha256(series_text(test.record.rows)),
                             .run = "",
                             .cost = {},
                             .warnings = {}});
  }
  require_judges(dataset, dataset, mapping.name);
  return dataset;
}

Dataset write_imported(const Mapping& mapping, const std::vector<ForeignTest>& foreign,
                       const std::vector<ImportedTest>& tests, const fs::path& output, const Execution& execution) {
  check_output(foreign, output);
  Dataset dataset = dataset_of(mapping, tests);
  make_output_folder(output);
  fs::remove(output / "dataset.json");  // written last: until then there is no data set
  dataset.provenance = provenance(execution);
  dataset.provenance["source"] = mapping.source;
  dataset.provenance["mapping"] = {{"file", mapping.name}, {"sha256", mapping.sha256}};
  dataset.provenance["tests"] = Json::object();
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const TestRecord& record = tests[i].record;
    write_series(output / (record.name + ".csv"), record.rows);
    remove_extra(output, record.name);
    if (!foreign[i].foreign.extra.titles.empty())
      write_durably(output / (record.name + ".extra.csv"), extra_text(foreign[i].foreign.extra));
    dataset.provenance["tests"][record.name] = Json(tests[i].provenance);
  }
  write_dataset_index(output, dataset);
  return read_dataset(output);
}

}  // namespace grainlaw::chain
