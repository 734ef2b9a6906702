#include "predict/prediction_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/files/column.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/files/path_json.hpp"
#include "model/files/reading.hpp"
#include "model/files/schema.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::predict {
namespace {

namespace fs = std::filesystem;

OrderedJson curve_to_json(const PredictedCurve& curve) {
  OrderedJson object = fields_to_json(curve);
  object["rows"] = curve.prediction.rows.size();
  object["unjammed"] = curve.prediction.unjammed;
  if (curve.prediction.unjammed) object["unjammed_at"] = fields_to_json(curve.prediction.unjammed_at);
  object["events"] = fields_to_json(curve.prediction.events);
  object["warnings"] = curve.prediction.warnings;
  object["solver"] = fields_to_json(curve.prediction.statistics);
  return object;
}

PredictedCurve curve_from_json(const Json& object) {
  PredictedCurve curve;
  read_fields(object, curve);
  if (!is_safe_name(curve.file))
    throw InvalidInput(fmt::format("file: '{}' is no name of a file", one_line(curve.file, 60)));
  curve.prediction.model = curve.model;
  curve.prediction.unjammed = object.at("unjammed");
  if (curve.prediction.unjammed) read_fields(object.at("unjammed_at"), curve.prediction.unjammed_at);
  read_fields(object.at("events"), curve.prediction.events);
  curve.prediction.warnings = object.at("warnings").get<std::vector<std::string>>();
  read_fields(object.at("solver"), curve.prediction.statistics);
  return curve;
}

/// What is wrong with a file, with its name.
template <class Read>
void read_named(const fs::path& file, const Read& read) {
  const std::string name = one_line(file.string(), 200);
  try {
    read();
  } catch (const Json::exception& error) {
    throw InvalidInput(
        fmt::format("{}: is not of this version: {}; run grainlaw predict again", name, one_line(error.what(), 200)));
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", name, one_line(error.what(), 300)));
  }
}

/// The other way round of rung_to_json().
void read_rung(const Json& object, PredictionFolder& content) {
  read_fields(object, content.needed);
  read_fields(object, content.recommended);
  read_fields(object.at("changes"), content.changes);
}

constexpr std::array kMeans{&QuantityComparison::bias, &QuantityComparison::rms, &QuantityComparison::normalised_rms,
                            &QuantityComparison::coverage_mean, &QuantityComparison::coverage_single};

}  // namespace

void write_prediction_series(const std::filesystem::path& file, const std::vector<PredictedRow>& rows) {
  write_durably(file, table_text(rows));
}

constexpr double kMostOfACurve = 1e100;  // what follows from the columns must be finite

std::vector<PredictedRow> read_prediction_series(const std::filesystem::path& file) {
  CsvReader reader(file);
  const auto columns = matched<PredictedRow>(reader);
  std::vector<PredictedRow> rows;
  std::vector<double> values;
  while (reader.next(values)) {
    PredictedRow row;
    row.state.sigma.setZero();
    row.state.F.setZero();
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::abs(values[i]) > kMostOfACurve) reader.refuse(columns[i]->name, "is beyond 1e100; predict again");
      set_value(reader, row, *columns[i], values[i]);
    }
    rows.push_back(row);
  }
  return rows;
}

std::vector<CurveComparison> mean_over_seeds(const std::vector<CurveComparison>& comparisons) {
  std::vector<CurveComparison> means;
  for (const Rung model : kRungs) {
    for (const Initial initial : kValues<Initial>) {
      CurveComparison mean{model, initial, std::nullopt, {"mean", {}}};
      bool any = false;
      std::vector<std::array<double, kMeans.size()>> seeds;  // that have the number, by quantity
      for (const CurveComparison& entry : comparisons) {
        if (entry.model != model || entry.initial != initial || !entry.seed) continue;
        any = true;
        auto& sums = mean.comparison.quantities;
        if (sums.empty()) {
          QuantityComparison none;
          none.coverage_mean = none.coverage_single = 0;
          sums.resize(entry.comparison.quantities.size(), none);
          seeds.resize(sums.size());
        }
        for (std::size_t i = 0; i < sums.size(); ++i) {
          const QuantityComparison& q = entry.comparison.quantities.at(i);
          sums[i].quantity = q.quantity;
          sums[i].rows += q.rows;
          for (std::size_t v = 0; v < kMeans.size(); ++v) {
            if (!std::isfinite(q.*kMeans[v])) continue;  // a run may not tell it
            sums[i].*kMeans[v] += q.*kMeans[v];
            seeds[i][v] += 1;
          }
          if (std::abs(q.largest) >= std::abs(sums[i].largest)) {
            sums[i].largest = q.largest;
            sums[i].largest_at_eps_dev = q.largest_at_eps_dev;
            sums[i].largest_at_nu = q.largest_at_nu;
          }
        }
      }
      if (!any) continue;
      for (std::size_t i = 0; i < seeds.size(); ++i) {
        for (std::size_t v = 0; v < kMeans.size(); ++v)  // NaN of none
          mean.comparison.quantities[i].*kMeans[v] /= seeds[i][v];
      }
      means.push_back(mean);
    }
  }
  return means;
}

OrderedJson rung_to_json(const PredictionFolder& content) {
  OrderedJson object = fields_to_json(content.needed);
  object.update(fields_to_json(content.recommended));
  object["changes"] = fields_to_json(content.changes);
  return object;
}

void write_prediction(const fs::path& folder, const PredictionFolder& content) {
  fs::remove(folder /
             "prediction.json");  // first, and written last: what a kill leaves is no mixture of two predictions
  fs::remove(folder / "comparison.json");
  OrderedJson curves = OrderedJson::array();
  std::set<std::string> files;
  for (const PredictedCurve& curve : content.curves) files.insert(curve.file);
  for (const fs::path& entry : entries_of(folder)) {  // curves of the prediction that was here
    const std::string name = entry.filename().string();
    const bool is_curve = std::ranges::any_of(kValues<Rung>, [&](Rung rung) {
      return name.starts_with(to_string(rung) + "-law") || name.starts_with(to_string(rung) + "-measured");
    });
    if (is_curve && entry.extension() == ".csv" && !files.contains(name)) fs::remove(entry);
  }
  for (const PredictedCurve& curve : content.curves) {
    write_prediction_series(folder / curve.file, curve.prediction.rows);
    curves.push_back(curve_to_json(curve));
  }
  if (content.dem) {
    write_json(folder / "comparison.json",
               {{"format", "grainlaw comparison"},
                {"format_version", 1},
                {"normalisation",
                 "normalised_rms = RMS(prediction - DEM)/max|DEM|, bias = mean(prediction - DEM), rows with "
                 "shear_path >= 0.01 (all rows without shear); coverage = share of these rows within the band; test "
                 "\"mean\": mean over seeds"},
                {"dataset_digest", content.dem->digest},
                {"comparisons", fields_to_json(content.comparisons)}});
  }
  OrderedJson document = OrderedJson::object();
  document["format"] = "grainlaw prediction";
  document["format_version"] = 1;
  document["name"] = content.name;
  document["path"] = path_to_json(content.path);
  document["parameters"] = OrderedJson(content.parameters);
  document["dem"] = content.dem ? OrderedJson("dem") : OrderedJson(nullptr);
  document["rung"] = rung_to_json(content);
  document["bands"] = content.bands;
  document["rehearsals"] = content.rehearsals ? fields_to_json(*content.rehearsals) : OrderedJson(nullptr);
  document["warnings"] = content.warnings;
  document["curves"] = curves;
  document["failures"] = fields_to_json(content.failures);
  document["provenance"] = OrderedJson(content.provenance);
  write_json(folder / "prediction.json", document);
}

PredictionFolder read_prediction(const fs::path& folder) {
  PredictionFolder content;
  content.name = folder.filename().string();
  const fs::path file = folder / "prediction.json", compared = folder / "comparison.json";
  const Json document = read_json(file, JsonSource::own);
  read_named(file, [&] {
    check_schema(document.at("path"), Schema::path, "path");
    content.path = path_from_json(document.at("path"), "path", "", true);
    content.parameters = document.at("parameters");
    content.provenance = document.at("provenance");
    read_rung(document.at("rung"), content);
    content.bands = document.at("bands");
    for (const Json& curve : document.at("curves")) content.curves.push_back(curve_from_json(curve));
    if (!document.at("rehearsals").is_null()) read_fields(document.at("rehearsals"), content.rehearsals.emplace());
    content.warnings = document.at("warnings").get<std::vector<std::string>>();
    read_fields(document.at("failures"), content.failures);
    document.at("dem");
  });
  for (std::size_t k = 0; k < content.curves.size(); ++k) {
    PredictedCurve& curve = content.curves[k];
    curve.prediction.rows = read_prediction_series(folder / curve.file);
    if (document["curves"][k].value("rows", Json()) != curve.prediction.rows.size())
      throw InvalidInput(fmt::format("{}: has {} rows, not those of its prediction.json; run grainlaw predict again",
                                     one_line((folder / curve.file).string(), 200), curve.prediction.rows.size()));
  }
  if (document["dem"].is_null()) return content;
  content.dem = read_dataset(folder / "dem");
  const Json comparison = read_json(compared, JsonSource::own);
  read_named(compared, [&] { read_fields(comparison.at("comparisons"), content.comparisons); });
  return content;
}

}  // namespace grainlaw::predict
