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
  command.add_option("-o,--output", *file, "file of the script; default: standard output")->type_name("FILE");
  return [shell, file, root = command.get_parent()](Session&) {
    write_as_named(file->empty() ? "-" : *file, completion_script(*root, *shell));
    return ExitCode::ok;
  };
}

Task declare_man(CLI::App& command) {
  const auto folder = std::make_shared<std::filesystem::path>();
  command.add_option("DIR", *folder, "folder for grainlaw.1 and the pages of the commands")
      ->required()
      ->type_name("DIR");
  return [folder, root = command.get_parent()](Session&) {
    write_manual(*root, *folder);
    return ExitCode::ok;
  };
}

}  // namespace grainlaw::app
