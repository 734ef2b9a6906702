// grainlaw check FILE...: whether files are sound, and what a command would do with them.

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/terminal/forecast_text.hpp"
#include "chain/inspection.hpp"
#include "model/files/fields_json.hpp"

namespace grainlaw::app {
namespace {

struct CheckOptions {
  std::vector<std::filesystem::path> files;
  std::filesystem::path output = "out";  ///< whose finished runs count as done
};

std::string inspection_text(const chain::Inspection& seen, int threads) {
  if (!seen.refusals.empty()) return "";
  std::string text = fmt::format("{}: {}, sound\n", seen.file, seen.kind);
  for (const std::string& line : seen.holds) text += fmt::format("  {}\n", line);
  return seen.forecast ? text + text_of(*seen.forecast, threads) : text;
}

OrderedJson inspection_json(const chain::Inspection& seen) {
  OrderedJson object{{"file", seen.file}, {"kind", seen.kind}, {"sound", seen.refusals.empty()}};
  object["holds"] = seen.holds;
  object["refusals"] = seen.refusals;
  if (seen.forecast) object["forecast"] = fields_to_json(*seen.forecast);
  return object;
}

ExitCode check(const CheckOptions& options, const Session& session) {
  const std::vector<chain::Inspection> all = chain::inspect(options.files, options.output, session);
  std::string text;
  OrderedJson array = OrderedJson::array();
  bool sound = true;
  for (const chain::Inspection& seen : all) {
    text += inspection_text(seen, session.threads);
    array.push_back(inspection_json(seen));
    sound = sound && seen.refusals.empty();
    for (const std::string& refusal : seen.refusals) std::fputs(fmt::format("grainlaw: {}\n", refusal).c_str(), stderr);
  }
  print_result(session.json ? json_text(array) : text);
  return sound ? ExitCode::ok : ExitCode::invalid_input;
}

}  // namespace

Task declare_check(CLI::App& command) {
  const auto options = std::make_shared<CheckOptions>();
  add_value(command, "FILES", options->files, "FILE",
            "SPEC, TEST, PATH, MAPPING, dataset.json, parameters.json, prior.json, series, table of spheres, state, or "
            "folder of a data set or calibration; a PATH is seen in the light of the others")
      ->required();
  add_value(command, "-o,--output", options->output, "DIR", "folder whose finished runs count as done")
      ->capture_default_str();
  return [options](Session& session) { return check(*options, session); };
}

}  // namespace grainlaw::app
