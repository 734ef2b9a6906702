// grainlaw import MAPPING.json -o DATASET: series and particles of others -> what their columns mean -> checks -> data set.

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/terminal/import_text.hpp"
#include "chain/import/import.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {
namespace {

struct ImportOptions {
  std::filesystem::path mapping;
  std::filesystem::path output;  ///< folder of the data set
  bool dry_run = false;
};

ExitCode import(const ImportOptions& options, const Session& session) {
  if (options.output.empty() && !options.dry_run)
    throw InvalidInput("import: misses the folder of the data set; give it with -o, or --dry-run");
  const chain::Mapping mapping = chain::read_mapping(options.mapping);
  const std::vector<chain::ForeignTest> foreign = chain::read_foreign(mapping, session);
  if (!session.json)
    print_result(columns_text(foreign));  // before anything is judged: a refusal may come of a wrong guess
  std::vector<chain::ImportedTest> tests;
  for (const chain::ForeignTest& test : foreign) tests.push_back(chain::imported(mapping, test));
  if (!session.json) print_result(paths_text(tests));
  for (const std::string& suspicion : chain::suspicions(tests)) session.watch.log("warning: " + suspicion);
  if (options.dry_run) {
    chain::dataset_of(mapping, tests);  // refuses what would be refused
  } else {
    const Dataset dataset = chain::write_imported(mapping, foreign, tests, options.output, session);
    if (!session.json) print_result(written_text(dataset, options.output));
  }
  if (session.json)
    print_result(json_text(import_json(foreign, tests, options.dry_run ? "" : options.output.string())));
  return ExitCode::ok;
}

}  // namespace

Task declare_import(CLI::App& command) {
  const auto options = std::make_shared<ImportOptions>();
  add_value(command, "MAPPING", options->mapping, "FILE", "MAPPING.json: files, what their columns mean, units, signs")
      ->required();
  add_value(command, "-o,--output", options->output, "DIR", "folder of the data set");
  command.add_flag("--dry-run", options->dry_run, "only show what columns are taken for and which paths are found");
  return [options](Session& session) { return import(*options, session); };
}

}  // namespace grainlaw::app
