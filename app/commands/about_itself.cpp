// grainlaw completion SHELL, grainlaw man DIR: what packages install, from the table of commands and options.

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/terminal/completion.hpp"
#include "app/terminal/manual.hpp"
#include "model/files/output.hpp"

namespace grainlaw::app {

Task declare_completion(CLI::App& command) {
  const auto shell = std::make_shared<Shell>();
  const auto file = std::make_shared<std::filesystem::path>();
  add_choice<Shell>(command, "SHELL", *shell, "whose script is wanted")->required();
  add_value(command, "-o,--output", *file, "FILE", "file of the script; default: standard output");
  return [shell, file, root = command.get_parent()](Session&) {
    write_as_named(file->empty() ? "-" : *file, completion_script(*root, *shell));
    return ExitCode::ok;
  };
}

Task declare_man(CLI::App& command) {
  const auto folder = std::make_shared<std::filesystem::path>();
  add_value(command, "DIR", *folder, "DIR", "folder for grainlaw.1 and the pages of the commands")->required();
  return [folder, root = command.get_parent()](Session&) {
    write_manual(*root, *folder);
    return ExitCode::ok;
  };
}

}  // namespace grainlaw::app
