#include "app/terminal/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "app/terminal/help.hpp"

namespace grainlaw::app {
namespace {

using Commands = std::vector<const CLI::App*>;

/// The program and all commands below it, outermost first.
Commands all_commands(const CLI::App& app) {
  Commands commands{&app};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const Commands below = commands_of(*commands[i]);
    commands.insert(commands.end(), below.begin(), below.end());
  }
  return commands;
}

/// The first clause: a line in a menu has no room for more.
std::string first_clause(const std::string& description) {
  std::string text = description.substr(0, description.find_first_of(";:("));
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

std::string replaced(std::string text, const std::string& characters, const std::string& before) {
  for (std::size_t i = 0; (i = text.find_first_of(characters, i)) != std::string::npos; i += before.size() + 1)
    text.insert(i, before);
  return text;
}

std::vector<std::string> names_below(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* below : commands_of(command)) names.push_back(below->get_name());
  return names;
}

/// What is typed there, as arguments of bash's compgen; empty: nothing is known.
std::string compgen(const OptionText& option) {
  if (!option.choices.empty()) return fmt::format("-W '{}'", fmt::join(option.choices, " "));
  return option.value == "FILE" ? "-f" : option.value == "DIR" ? "-d" : "";
}

std::string bash_case(const CLI::App& command) {
  std::string text = fmt::format("    '{}')\n      case $previous in\n", full_name(command));
  std::vector<std::string> words = names_below(command);
  std::string files;
  for (const OptionText& option : options_of(command)) {
    if (option.positional) {
      if (const std::string more = compgen(option); files.find(more) == std::string::npos) files += " " + more;
      continue;
    }
    words.insert(words.end(), option.names.begin(), option.names.end());
    if (option.value.empty()) continue;
    text += fmt::format("        {}) COMPREPLY=({}); return ;;\n", fmt::join(option.names, "|"),
                        compgen(option).empty() ? "" : fmt::format("$(compgen {} -- \"$current\")", compgen(option)));
  }
  text += "      esac\n";
  text += fmt::format("      COMPREPLY=($(compgen -W '{}' -- \"$current\"))\n", fmt::join(words, " "));
  if (!files.empty())
    text += fmt::format("      [[ $current == -* ]] || COMPREPLY=($(compgen{} -- \"$current\"))\n", files);
  return text + "      ;;\n";
}

std::string bash_script(const CLI::App& app) {
  std::string text = R"(# bash completion of grainlaw, made by `grainlaw completion bash`
_grainlaw() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command=grainlaw word
  compopt -o filenames 2>/dev/null
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    case "$command $word" in
)";
  std::vector<std::string> names;
  const Commands commands = all_commands(app);
  for (const CLI::App* command : commands) {
    if (command != &app) names.push_back(in_quotes(full_name(*command)));
  }
  text += fmt::format("      {}) command=\"$command $word\" ;;\n    esac\n  done\n  case $command in\n",
                      fmt::join(names, "|"));
  for (const CLI::App* command : commands) text += bash_case(*command);
  return text + "  esac\n}\ncomplete -F _grainlaw grainlaw\n";
}

/// What is typed there, as zsh's _arguments wants it.
std::string zsh_action(const OptionText& option) {
  if (!option.choices.empty()) return fmt::format("({})", fmt::join(option.choices, " "));
  return option.value == "FILE" ? "_files" : option.value == "DIR" ? "_files -/" : " ";
}

std::string zsh_name(const CLI::App& command) {
  std::string name = "_" + full_name(command);
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

std::string zsh_arguments(const CLI::App& command) {
  std::string text = fmt::format("{}() {{\n  _arguments -C", zsh_name(command));
  for (const OptionText& option : options_of(command)) {
    const std::string what = replaced(first_clause(option.description), "[]:\\", "\\");
    if (option.positional) {
      text += " \\\n    " + in_quotes(fmt::format("{}:{}:{}", option.many ? "*" : "", what, zsh_action(option)));
      continue;
    }
    const std::string others = fmt::format("({})", fmt::join(option.names, " "));
    for (const std::string& name : option.names) {
      std::string spec = fmt::format("{}{}[{}]", option.many ? "*" : others, name, what);
      if (!option.value.empty())
        spec += fmt::format(":{}:{}", option.choices.empty() ? option.value : "choice", zsh_action(option));
      text += " \\\n    " + in_quotes(spec);
    }
  }
  const Commands below = commands_of(command);
  if (below.empty()) return text + "\n}\n";
  text += " \\\n    '1: :->command' '*:: :->rest'\n  case $state in\n    command)\n      local -a commands=(";
  for (const CLI::App* each : below)
    text += " " + in_quotes(each->get_name() + ":" + first_clause(each->get_description()));
  text += ")\n      _describe command commands ;;\n    rest)\n      case $words[1] in\n";
  for (const CLI::App* each : below) text += fmt::format("        {}) {} ;;\n", each->get_name(), zsh_name(*each));
  return text + "      esac ;;\n  esac\n}\n";
}

std::string zsh_script(const CLI::App& app) {
  std::string text = "#compdef grainlaw\n# zsh completion of grainlaw, made by `grainlaw completion zsh`\n";
  for (const CLI::App* command : all_commands(app)) text += zsh_arguments(*command);
  return text + "_grainlaw \"$@\"\n";
}

/// When fish is at this command: all its words were given, none of a command below it.
std::string fish_condition(const CLI::App& command) {
  std::string text;
  for (const CLI::App* c = &command; c->get_parent() != nullptr; c = c->get_parent())
    text = fmt::format("__fish_seen_subcommand_from {}{}{}", c->get_name(), text.empty() ? "" : "; and ", text);
  const std::vector<std::string> below = names_below(command);
  if (below.empty()) return text;
  return fmt::format("{}not __fish_seen_subcommand_from {}", text.empty() ? "" : text + "; and ",
                     fmt::join(below, " "));
}

std::string fish_script(const CLI::App& app) {
  std::string text = "# fish completion of grainlaw, made by `grainlaw completion fish`\ncomplete -c grainlaw -f\n";
  for (const CLI::App* command : all_commands(app)) {
    const std::string at = fmt::format("complete -c grainlaw -n {}", in_quotes(fish_condition(*command)));
    for (const CLI::App* below : commands_of(*command))
      text += fmt::format("{} -a {} -d {}\n", at, below->get_name(), in_quotes(first_clause(below->get_description())));
    for (const OptionText& option : options_of(*command)) {
      std::string line = at;
      for (const std::string& name : option.positional ? std::vector<std::string>{} : option.names)
        line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!option.choices.empty())
        line += fmt::format(" -x -a {}", in_quotes(fmt::format("{}", fmt::join(option.choices, " "))));
      else if (option.value == "DIR")
        line += " -x -a '(__fish_complete_directories)'";
      else if (option.value == "FILE")
        line += option.positional ? " -F" : " -r -F";
      else if (!option.value.empty())
        line += " -x";
      text += fmt::format("{} -d {}\n", line, in_quotes(first_clause(option.description)));
    }
  }
  return text;
}

}  // namespace

std::string in_quotes(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

std::string completion_script(const CLI::App& app, Shell shell) {
  return shell == Shell::bash ? bash_script(app) : shell == Shell::zsh ? zsh_script(app) : fish_script(app);
}

}  // namespace grainlaw::app
