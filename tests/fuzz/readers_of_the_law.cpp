#include "chain/fitted_paths.hpp"
#include "chain/studies/settings_study.hpp"
#include "fit/calibrate.hpp"
#include "fit/calibration_file.hpp"
#include "fit/prior_file.hpp"
#include "model/parameters_file.hpp"
#include "predict/prediction_files.hpp"
#include "tests/fuzz/readers.hpp"

namespace grainlaw::fuzz {
namespace {

namespace fs = std::filesystem;

void read_law(const fs::path& file) {
  const fs::path again = file.parent_path() / "again.json";
  const auto written = [&](const ParametersFile& parameters) {
    write_parameters(again, parameters);
    return content(again);
  };
  const ParametersFile parameters = read_parameters(file);
  check_round_trip([&] { return written(parameters); },
                   [&](const std::string&) { return written(read_parameters(again)); });
}

}  // namespace

std::vector<Reader> readers_of_the_law(const fs::path& scene) {
  const CalibratedLaw law = read_parameters(scene / "fitted_paths/parameters.json").law;
  return {
      {"parameters", Shape::json, "parameters/parameters.json",
       [](std::string_view, const fs::path& file) { read_law(file); }},
      {"prior", Shape::json, "prior/prior.json",
       [](std::string_view, const fs::path& file) { json_text(fit::prior_to_json(fit::read_prior(file))); }},
      {"calibration", Shape::json, "calibration/calibration.json",
       [](std::string_view, const fs::path& file) {
         fit::Calibration calibration;
         fit::read_calibration(file, calibration);
       }},
      {"fitted_paths", Shape::json, "fitted_paths/fitted_paths.json",
       [law](std::string_view, const fs::path& file) { chain::read_fitted_paths(file, law); }},
      {"prediction", Shape::json, "prediction/prediction.json",
       [](std::string_view, const fs::path& file) { predict::read_prediction(file.parent_path()); }},
      {"comparison", Shape::json, "comparison/comparison.json",
       [](std::string_view, const fs::path& file) { predict::read_prediction(file.parent_path()); }},
      {"curve", Shape::csv, "curve/curve.csv",
       [](std::string_view, const fs::path& file) {
         const auto rows = predict::read_prediction_series(file);
         const fs::path again = file.parent_path() / "again.csv";
         check_round_trip(  // of deviators that are none only so far: their trace goes, in rounding
             [&] { return std::to_string(rows.size()); },
             [&](const std::string&) {
               predict::write_prediction_series(again, rows);
               return std::to_string(predict::read_prediction_series(again).size());
             });
       }},
      {"study", Shape::json, "study/study.json",
       [](std::string_view, const fs::path& file) {
         const Json document = read_json(file, JsonSource::own);
         try {
           chain::study_from_json(document);
         } catch (const Json::exception&) {  // that of its kind, see there
         }
       }},
  };
}

}  // namespace grainlaw::fuzz
