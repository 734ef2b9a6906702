// grainlaw study prior DIR [DIR...]: what many packings say of the errors of few.

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/terminal/session.hpp"
#include "chain/studies/prior_study.hpp"
#include "fit/prior_file.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/output.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

struct PriorOptions {
  fs::path many;                 ///< folder of a data set or of a calibration
  std::vector<fs::path> others;  ///< likewise, other sizes
  fs::path output;               ///< folder for prior.json
};

std::string text_of(const chain::PriorStudy& study, const fs::path& file) {
  std::string text = "Calibrations of few packings: how often intervals hold what all packings find\n\n";
  text += fmt::format("{:>10} {:>9} {:>13} {:>7} {:>10} {:>12} {:>10}\n", "particles", "packings", "calibrations",
                      "ratio", "moderated", "unmoderated", "narrower");
  for (const chain::FewPackings& f : study.few)
    text += fmt::format("{:>10.0f} {:>9} {:>13} {:>7.2f} {:>8.1f} % {:>10.1f} % {:>10.2f}\n", f.particles, f.packings,
                        f.calibrations, f.ratio, 100 * f.coverage, 100 * f.unmoderated, f.narrower);
  text += "\nBiased by the size, beyond chance\n\n";
  for (const chain::SizeEffect& s : study.sizes) {
    if (s.biased)
      text += fmt::format("{}\n  {:>8.0f}: {:>10.4g} ± {:<10.2g} {:>8.0f}: {:>10.4g} ± {:<10.2g} {:>6.1f}\n",
                          s.parameter, s.particles, s.value, s.standard_error, s.larger_particles, s.larger_value,
                          s.larger_standard_error, s.distance);
  }
  return text + "\n" + file.string() + "\n";
}

ExitCode study_prior(const PriorOptions& options, Session& session) {
  const chain::PriorStudy study = chain::study_prior(options.many, options.others, session);
  make_output_folder(options.output);
  OrderedJson document{{"format", "grainlaw prior"}, {"format_version", 1}};
  document.update(fit::prior_to_json(study.prior));
  document["few"] = fields_to_json(study.few);
  document["sizes"] = fields_to_json(study.sizes);
  document["provenance"] = provenance(session);
  write_json(options.output / "prior.json", document);
  print_result(session.json ? json_text(document) : text_of(study, options.output / "prior.json"));
  return ExitCode::ok;
}

}  // namespace

Task declare_study_prior(CLI::App& command) {
  const auto options = std::make_shared<PriorOptions>();
  add_value(command, "MANY", options->many, "DIR", "folder of a data set or calibration of 16 packings or more")
      ->required();
  add_value(command, "OTHERS", options->others, "DIR", "likewise, of the same tests on packings of other sizes");
  add_value(command, "-o,--output", options->output, "DIR", "folder for prior.json")->required();
  return [options](Session& session) { return study_prior(*options, session); };
}

}  // namespace grainlaw::app
