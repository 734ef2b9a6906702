// grainlaw export STATE|RUN|DATASET --format FORMAT -o DIR: spheres, contacts and series as files of other programs.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/terminal/result_text.hpp"
#include "chain/export.hpp"

namespace grainlaw::app {
namespace {

struct ExportOptions {
  std::filesystem::path source;
  chain::ExportFormat format = chain::ExportFormat::vtp;
  std::filesystem::path output;
};

ExitCode export_source(const ExportOptions& options, const Session& session) {
  const chain::Exported done =
      chain::export_files(options.source, options.format, options.output, {.report = {}, .stop = session.stop});
  if (session.json) {
    print_result(json_text({{"states", done.states}, {"series", done.series}, {"files", done.files}}));
  } else {
    const std::string what = done.states > 0 ? fmt::format("{} state{}", done.states, done.states == 1 ? "" : "s")
                                             : fmt::format("{} series", done.series);
    print_result(fmt::format("{} as {} in {}: {}{}\n", what, to_string(options.format), options.output.string(),
                             done.files.front(),
                             done.files.size() > 1 ? fmt::format(", ... {}", done.files.back()) : ""));
  }
  return ExitCode::ok;
}

}  // namespace

Task declare_export(CLI::App& command) {
  const auto options = std::make_shared<ExportOptions>();
  add_value(command, "SOURCE", options->source, "FILE", "state file, folder of simulate, or data set")->required();
  add_choice<chain::ExportFormat>(command, "--format", options->format, "what is written")->required();
  add_value(command, "-o,--output", options->output, "DIR", "folder for the files")->required();
  return [options](Session& session) { return export_source(*options, session); };
}

}  // namespace grainlaw::app
