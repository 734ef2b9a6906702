// grainlaw init spec | test | path | dataset [-o FILE]: a commented starter that runs as it is.

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"
#include "starter_texts.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

enum class Starter { spec, test, path, dataset };
constexpr auto names_of(Starter) { return std::array{"spec", "test", "path", "dataset"}; }

struct InitOptions {
  Starter kind = Starter::spec;
  fs::path output;  ///< file, of a data set folder; empty: named after the kind
};

/// The folder of the schemas that were installed with this program, as editors take it; empty when there is none.
std::string schemas_url() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path folder = program.parent_path().parent_path() / "share/grainlaw/schemas";
  return !error && fs::exists(folder, error) ? "file://" + folder.string() : "";
}

/// The text with the schema of this machine: the starters name those of the source tree, for editors there.
std::string localised(std::string text) {
  constexpr std::string_view in_source = "docs/schemas/";  // below some "../"
  const std::size_t at = text.find(in_source);
  if (at == std::string::npos) return text;
  const std::string url = schemas_url();
  const std::size_t begin = text.rfind(url.empty() ? '\n' : '"', at) + 1;
  if (!url.empty()) return text.replace(begin, at + in_source.size() - begin, url + "/");
  return text.erase(begin, text.find('\n', at) + 1 - begin);
}

/// Of a kind: each file's place below `output`, a file or of a data set a folder, and its text.
std::vector<std::pair<fs::path, std::string>> files_of(Starter kind, const fs::path& output) {
  const bool dataset = kind == Starter::dataset;
  const std::string name = to_string(kind) + (dataset ? "/" : ".json");
  std::vector<std::pair<fs::path, std::string>> files;
  for (const auto& [file, text] : starters::kFiles) {
    if (!file.starts_with(name)) continue;
    files.emplace_back(dataset ? output / file.substr(name.size()) : output, localised(text));
    if (output != "-" && fs::exists(files.back().first))
      throw InvalidInput(fmt::format("{}: is there already and was left alone; give another name with -o",
                                     files.back().first.string()));
  }
  return files;
}

ExitCode init(const InitOptions& options) {
  const bool dataset = options.kind == Starter::dataset;
  const std::string name = to_string(options.kind) + (dataset ? "" : ".json");
  const fs::path output = options.output.empty() ? fs::path(name) : options.output;
  const bool to_output = output == "-";
  if (to_output && dataset) throw InvalidInput("init: a data set is a folder; name one with -o");
  const auto files = files_of(options.kind, output);
  if (dataset) make_output_folder(output);
  for (const auto& [file, text] : files) write_as_named(file, text);
  if (to_output) return ExitCode::ok;
  const char* next = options.kind == Starter::spec   ? "grainlaw calibrate {} -o out"
                     : options.kind == Starter::test ? "grainlaw simulate {} -o out"
                     : options.kind == Starter::path ? "grainlaw predict out/parameters.json {} -o out/predictions/mine"
                                                     : "grainlaw calibrate --dataset {} -o out";
  print_result(fmt::format("{}\nnext: grainlaw check {}\n      {}\n", output.string(), output.string(),
                           fmt::format(fmt::runtime(next), output.string())));
  return ExitCode::ok;
}

}  // namespace

Task declare_init(CLI::App& command) {
  const auto options = std::make_shared<InitOptions>();
  add_choice<Starter>(command, "KIND", options->kind, "of the starter")->required();
  add_value(command, "-o,--output", options->output, "FILE",
            "file, - for standard output, or folder of a data set (default: named after KIND)");
  return [options](Session&) { return init(*options); };
}

}  // namespace grainlaw::app
