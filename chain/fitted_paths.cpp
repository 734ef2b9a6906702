#include "chain/fitted_paths.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "model/files/fields_json.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/files/path_json.hpp"
#include "model/files/schema.hpp"
#include "model/vocabulary/error.hpp"
#include "predict/predict.hpp"
#include "predict/rung_advice.hpp"

namespace grainlaw::chain {
namespace {

constexpr int kSteps = 60;  // of a curve

FittedCurve curve_along(const CalibratedLaw& law, Rung rung, const Path& path, const Execution& execution) {
  const auto segments = resolve(path);
  const predict::Prediction prediction = predict::predict(
      rung, law.parameters, law.coupling, segments, predict::state_from_law(law.parameters, path.nu),
      predict::uniform_points(segments, kSteps), predict::Tolerances{}, law.range, {{}, execution.stop});
  FittedCurve curve{rung, {}, {}, {}, {}};
  for (const predict::PredictedRow& row : prediction.rows) {
    curve.eps_dev.push_back(row.eps_dev);
    curve.P_star.push_back(row.state.P);
    curve.s_par.push_back(row.s_par);
    curve.F_par.push_back(row.F_par);
  }
  return curve;
}

}  // namespace

std::optional<Rung> recommended_along(const CalibratedLaw& law, const Path& path) {
  const std::vector<Rung> rungs = calibrated_rungs(law);
  if (rungs.empty()) return std::nullopt;
  const auto segments = resolve(path);
  return predict::recommended_rung(law.rehearsals, segments, rungs, predict::rung_needed(law.parameters, segments))
      .rung;
}

std::vector<FittedPath> fitted_paths(const CalibratedLaw& law, const std::vector<TestRecord>& tests,
                                     const Execution& execution) {
  std::vector<FittedPath> paths;
  std::vector<Json> known;
  for (const TestRecord& test : tests) {
    const Json path = Json(path_to_json(test.path));
    if (!is_pure_shear(test) || std::ranges::find(known, path) != known.end()) continue;
    known.push_back(path);
    FittedPath& fitted = paths.emplace_back(FittedPath{test.path, {}});
    for (const Rung rung : calibrated_rungs(law)) {
      try {
        fitted.curves.push_back(curve_along(law, rung, test.path, execution));
      } catch (const InvalidInput&) {  // the law has its jamming above this density: there is no curve to draw
      } catch (const NotConverged&) {
      }
    }
  }
  return paths;
}

void write_fitted_paths(const std::filesystem::path& file, const std::vector<FittedPath>& paths,
                        const OrderedJson& provenance) {
  OrderedJson document{{"format", "grainlaw fitted paths"}, {"format_version", 1}};
  OrderedJson& list = document["paths"] = OrderedJson::array();
  for (const FittedPath& each : paths)
    list.push_back({{"path", path_to_json(each.path)}, {"curves", fields_to_json(each.curves)}});
  document["provenance"] = provenance;
  write_json(file, document);
}

std::vector<FittedPath> read_fitted_paths(const std::filesystem::path& file, const CalibratedLaw& law) {
  std::vector<FittedPath> paths;
  if (!std::filesystem::exists(file)) return paths;
  const Json document = read_json(file, JsonSource::own);
  try {
    for (const Json& object : document.at("paths")) {
      FittedPath& fitted = paths.emplace_back();
      const std::string place = fmt::format("paths[{}].path", paths.size() - 1);
      check_schema(object.at("path"), Schema::path, place);
      fitted.path = path_from_json(object.at("path"), place, "", true);
      read_fields(object.at("curves"), fitted.curves);
      for (const FittedCurve& curve : fitted.curves) {
        for (const auto* column : {&curve.P_star, &curve.s_par, &curve.F_par}) {
          if (column->size() != curve.eps_dev.size())
            throw InvalidInput(fmt::format("paths[{}].curves: columns differ in length", paths.size() - 1));
        }
      }
      fitted.recommended = recommended_along(law, fitted.path).value_or(Rung::reduced);
    }
  } catch (const Json::exception& error) {
    throw InvalidInput(fmt::format("{}: {}", file.string(), one_line(error.what(), 200)));
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", file.string(), one_line(error.what(), 300)));
  }
  return paths;
}

}  // namespace grainlaw::chain
