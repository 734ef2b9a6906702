#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/files/csv_table.hpp"
#include "model/files/dataset.hpp"
#include "model/files/json_document.hpp"
#include "model/files/output.hpp"
#include "model/files/path_file.hpp"
#include "model/files/path_json.hpp"
#include "model/files/schema.hpp"
#include "model/files/series_csv.hpp"
#include "model/vocabulary/error.hpp"
#include "model/vocabulary/series_check.hpp"
#include "tests/fuzz/readers.hpp"

namespace grainlaw::fuzz {
namespace {

namespace fs = std::filesystem;

Json parsed(std::string_view bytes, JsonSource source) {
  const Json document = parse_json(bytes, "bytes", source);
  check_round_trip(
      [&] { return json_text(OrderedJson(document)); },
      [](const std::string& text) { return json_text(OrderedJson(parse_json(text, "bytes", JsonSource::own))); });
  return document;
}

void read_table(const fs::path& file) {
  CsvReader reader(file);
  std::vector<double> row;
  while (reader.next(row)) {
    for (const double value : row) {
      if (std::isinf(value) || row.size() != reader.header().size()) throw Finding("a row is not what was promised");
    }
  }
}

/// Of a velocity gradient D and W are kept: components that are small beside others come back as their sum, rounded.
void settle_gradients(OrderedJson& path, const OrderedJson& like) {
  for (std::size_t k = 0; k < path["segments"].size() && k < like["segments"].size(); ++k) {
    if (!path["segments"][k].contains("velocity_gradient") || !like["segments"][k].contains("velocity_gradient"))
      continue;
    OrderedJson& L = path["segments"][k]["velocity_gradient"];
    const OrderedJson& M = like["segments"][k]["velocity_gradient"];
    double most = 0;
    for (const OrderedJson& row : M) {
      for (const OrderedJson& value : row) most = std::max(most, std::abs(value.get<double>()));
    }
    for (std::size_t i = 0; i < 9; ++i) {
      const double off = std::abs(L[i / 3][i % 3].get<double>() - M[i / 3][i % 3].get<double>());
      if (off <= 4e-16 * most) L[i / 3][i % 3] = M[i / 3][i % 3];
    }
  }
}

void check_path_round_trip(const Path& path) {
  const OrderedJson written = path_to_json(path);
  check_round_trip([&] { return json_text(written); },
                   [&](const std::string& text) {
                     OrderedJson back =
                         path_to_json(path_from_json(parse_json(text, "again", JsonSource::own), "again", "", true));
                     settle_gradients(back, written);
                     return json_text(back);
                   });
}

}  // namespace

std::vector<Reader> readers_of_model(const fs::path& scene) {
  const auto read_path_file = [](std::string_view, const fs::path& file) {
    check_path_round_trip(read_path(file).path);
  };
  // a table by itself: what it is judged by comes from its data set, read once
  const TestRecord record = read_dataset(scene / "dataset").tests.at(0).record;
  return {
      {"json", Shape::json, "", [](std::string_view bytes, const fs::path&) { parsed(bytes, JsonSource::user); }},
      {"json-own", Shape::json, "", [](std::string_view bytes, const fs::path&) { parsed(bytes, JsonSource::own); }},
      {"schema", Shape::json, "",
       [](std::string_view bytes, const fs::path&) {
         const Json document = parse_json(bytes, "bytes", JsonSource::user);
         for (const Schema which : {Schema::spec, Schema::path, Schema::test, Schema::dataset, Schema::parameters,
                                    Schema::study, Schema::study_settings, Schema::plan, Schema::prior})
           for (const std::string& text : schema_violations(document, which, "bytes")) check_message(text, "bytes");
       }},
      {"csv", Shape::csv, "csv/table.csv", [](std::string_view, const fs::path& file) { read_table(file); }},
      {"path", Shape::json, "path/path.json", read_path_file},
      {"strain", Shape::csv, "strain/strain.csv",
       [](std::string_view, const fs::path& file) {
         check_path_round_trip(read_path(file.parent_path() / "path.json").path);
       }},
      {"series", Shape::csv, "series/series.csv",
       [record](std::string_view, const fs::path& file) {
         const auto read = [&](const fs::path& from) {
           std::vector<Observation> rows = read_series(from, record.path, record.packing);
           check_series(rows, record.path, record.packing, from.string());
           return rows;
         };
         const std::vector<Observation> rows = read(file);
         check_round_trip([&] { return series_text(rows); },
                          [&](const std::string& text) {
                            write_durably(file.parent_path() / "again.csv", text);
                            return series_text(read(file.parent_path() / "again.csv"));
                          });
       }},
      {"dataset", Shape::json, "dataset/dataset.json",
       [](std::string_view, const fs::path& file) {
         const Dataset dataset = read_dataset(file.parent_path());
         for (const DatasetTest& test : dataset.tests) {
           check_path_round_trip(test.record.path);
           if (!std::isfinite(test.record.packing.stress_unit())) throw Finding("a packing has no unit of stress");
         }
       }},
  };
}

}  // namespace grainlaw::fuzz
