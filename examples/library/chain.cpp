// From a spec to a law, to a prediction beside new grains, to what a report shows: the chain as library calls.
//   chain SPEC.json PATH.json OUT
#include <cstdio>
#include <exception>
#include <stop_token>

#include "chain/calibration.hpp"
#include "chain/prediction.hpp"
#include "chain/report_input.hpp"

using namespace grainlaw;

namespace {

std::stop_source interrupt;  // request_stop() on it, from any thread, ends a call; finished runs are found again

struct Messages : Watch {
  void log(const std::string& text) override { std::fprintf(stderr, "%s\n", text.c_str()); }
};

void run(const std::filesystem::path& spec, const std::filesystem::path& path, const std::filesystem::path& out) {
  Messages messages;
  const Execution execution{.threads = 2, .stop = interrupt.get_token(), .watch = messages};

  // spec -> runs of a data set (those in OUT/runs are found again) -> calibrated law; OUT/parameters.json holds it
  const chain::CalibrationInput input = chain::read_calibration_input(spec, {});
  const auto result = chain::calibrate(input, chain::fit_options_of(input, execution), out, execution);
  const CalibratedLaw& law = result.calibration.law;
  std::printf("tests %zu\nconverged %d\n", result.dataset.tests.size(), law.converged);
  std::printf("P_star_at_0.74 %.17g\n", law.parameters.isotropic.P_star(0.74));

  // law + strain path -> prediction with bands, compared with the same path on packings that no fit saw
  chain::PredictionInput prediction_input = chain::read_prediction_input(out / "parameters.json", path);
  prediction_input.new_runs = {*input.spec, {}, out};
  const auto prediction = chain::predict_path(prediction_input, out / "predictions" / path.stem(), execution);
  for (const predict::CurveComparison& entry : prediction.comparisons) {
    if (entry.seed) continue;  // of one packing; the mean over them has none
    for (const auto& q : entry.comparison.quantities)
      std::printf("%s.%s.%s %.17g\n", to_string(entry.model).c_str(), to_string(entry.initial).c_str(),
                  q.quantity.c_str(), q.normalised_rms);
  }

  // all of it, as a report would show it
  const chain::ReportInput report = chain::read_report_input(out);
  std::printf("predictions %zu\nwarnings %zu\n", report.predictions.size(), report.warnings.size());
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fputs("usage: chain SPEC.json PATH.json OUT\n", stderr);
    return 2;
  }
  run(argv[1], argv[2], argv[3]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "chain: %s\n", error.what());
  return 1;
}
