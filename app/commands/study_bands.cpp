// grainlaw study bands FOLDER: whether bands hold on paths that are left out of what they are made of.

#include "app/commands/commands.hpp"
#include "app/commands/finish_study.hpp"
#include "app/commands/options.hpp"
#include "chain/studies/bands_study.hpp"
#include "model/files/output.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

struct BandsOptions {
  fs::path folder;             ///< of a calibration
  std::vector<fs::path> runs;  ///< more rehearsals
  fs::path output;             ///< folder for study.json
};

ExitCode study_bands(const BandsOptions& options, Session& session) {
  const chain::BandsStudy study = chain::study_bands(options.folder, options.runs, session);
  make_output_folder(options.output);
  return finish_study(study, options.output, nullptr, session);
}

}  // namespace

Task declare_study_bands(CLI::App& command) {
  const auto options = std::make_shared<BandsOptions>();
  add_value(command, "FOLDER", options->folder, "DIR", "folder of a calibration with rehearsals")->required();
  add_value(command, "--runs", options->runs, "DIR",
            "more rehearsals: folders of data sets, or of predictions with --dem, of one path each");
  add_value(command, "-o,--output", options->output, "DIR", "folder for study.json")->required();
  return [options](Session& session) { return study_bands(*options, session); };
}

}  // namespace grainlaw::app
