#include "app/terminal/help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "model/files/one_line.hpp"
#include "model/vocabulary/nearest_word.hpp"

namespace grainlaw::app {
namespace {

constexpr std::size_t kColumns = 80;
constexpr std::size_t kNameColumn = 26;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find(at, begin)) != std::string::npos; begin = end + 1)
    parts.push_back(text.substr(begin, end - begin));
  parts.push_back(text.substr(begin));
  return parts;
}

/// `name` and what it says beside it, continued below.
std::string entry(const std::string& name, const std::string& description) {
  std::string text = "  " + name;
  const std::vector<std::string> lines = wrapped(description, kColumns - kNameColumn);
  if (text.size() + 2 > kNameColumn && !description.empty()) text += "\n";
  for (const std::string& line : lines) {
    const std::size_t last = text.rfind('\n');
    const std::size_t column = text.size() - (last == std::string::npos ? 0 : last + 1);
    text += std::string(kNameColumn - column, ' ') + line + "\n";
  }
  return description.empty() ? text + "\n" : text;
}

OptionText text_of(const CLI::Option& option) {
  OptionText text;
  text.positional = option.get_positional();
  text.required = option.get_required();
  text.many = option.get_expected_max() > 1;
  if (text.positional) {
    text.names = {option.get_name(true, false)};
  } else {
    for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  }
  text.description = option.get_description();
  // the type name, then the descriptions of validators
  std::vector<std::string> type = split(option.get_type_name(), ':');
  if (option.get_type_size() != 0) text.value = type.front();
  if (text.value.find('|') != std::string::npos) text.choices = split(text.value, '|');
  std::vector<std::string> remarks(type.begin() + 1, type.end());
  if (text.positional && !text.choices.empty()) remarks.push_back(fmt::format("{}", fmt::join(text.choices, ", ")));
  if (!option.get_default_str().empty()) remarks.push_back("default " + option.get_default_str());
  if (!remarks.empty()) text.description += fmt::format(" ({})", fmt::join(remarks, "; "));
  return text;
}

std::string left_column(const OptionText& option) {
  std::string text = fmt::format("{}", fmt::join(option.names, ", "));
  if (!option.positional && !option.value.empty()) text += " " + option.value;
  if (option.many) text += "...";
  return text;
}

class OwnHelp : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const override {
    std::string text;
    for (const std::string& line : wrapped(app->get_description(), kColumns)) text += line + "\n";
    text += "\nUsage: ";
    const std::vector<std::string> usage = wrapped(synopsis(*app), kColumns - 9);
    text += fmt::format("{}\n", fmt::join(usage, "\n         "));
    const std::vector<const CLI::App*> commands = commands_of(*app);
    if (!commands.empty()) text += "\nCommands:\n";
    for (const CLI::App* command : commands) text += entry(command->get_name(), command->get_description());
    const std::vector<OptionText> options = options_of(*app);
    for (const bool positional : {true, false}) {
      bool first = true;
      for (const OptionText& option : options) {
        if (option.positional != positional) continue;
        if (std::exchange(first, false)) text += positional ? "\nArguments:\n" : "\nOptions:\n";
        text += entry(left_column(option), option.description + (option.required && !positional ? " (required)" : ""));
      }
    }
    return text + "\n" + app->get_footer() + "\n";
  }
};

}  // namespace

std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines;
  for (const std::string& word : split(text, ' ')) {
    if (!lines.empty() && lines.back().size() + 1 + word.size() <= width)
      lines.back() += " " + word;
    else
      lines.push_back(word);
  }
  return lines;
}

std::vector<OptionText> options_of(const CLI::App& command) {
  std::vector<OptionText> options;
  for (const CLI::Option* option : command.get_options([](const CLI::Option* o) { return !o->get_group().empty(); }))
    options.push_back(text_of(*option));
  std::stable_partition(options.begin(), options.end(), [](const OptionText& o) { return o.positional; });
  return options;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

std::string full_name(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return parent == nullptr ? command.get_name() : full_name(*parent) + " " + command.get_name();
}

std::string synopsis(const CLI::App& command) {
  std::string text = full_name(command);
  bool others = false;
  for (const OptionText& option : options_of(command)) {
    if (option.positional) {
      const std::string word = option.names.front() + (option.many ? "..." : "");
      text += option.required ? " " + word : " [" + word + "]";
    } else if (option.required) {
      text += " " + option.names.front() + " " + option.value;
    } else {
      others = true;
    }
  }
  if (!commands_of(command).empty()) text += " COMMAND";
  return others ? text + " [OPTIONS]" : text;
}

void use_own_help(CLI::App& app) { app.formatter(std::make_shared<OwnHelp>()); }

std::string overview(const CLI::App& app) {
  std::string text = app.get_description() + "\n\n";
  for (const auto& [line, what] : {std::pair{"grainlaw init spec -o spec.json", "a commented starter"},
                                   {"grainlaw check spec.json", "what it would run, how long, how much disk"},
                                   {"grainlaw calibrate spec.json -o out", "packings, tests, the law's parameters"},
                                   {"grainlaw predict out/parameters.json path.json -o out/predictions/mine", ""},
                                   {"grainlaw report out -o report.html", "one page about it"}})
    text += *what == '\0' ? fmt::format("  {}\n", line) : fmt::format("  {:<37} {}\n", line, what);
  text += "\nCommands:\n";
  for (const CLI::App* command : commands_of(app)) text += entry(command->get_name(), command->get_description());
  return text + "\ngrainlaw help COMMAND says more.\n";
}

const CLI::App& command_of(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  for (const std::string& word : words) {
    const auto below = command->get_subcommands([&](const CLI::App* c) { return c->get_name() == word; });
    if (below.empty()) break;
    command = below.front();
  }
  return *command;
}

std::string slip_in(const CLI::App& app, const std::vector<std::string>& words) {
  const auto unknown = [](const char* what, const std::string& word, const std::vector<std::string>& known,
                          const std::string& otherwise) {
    const std::string meant = nearest_word(word, known);
    return fmt::format("unknown {} '{}'; {}", what, one_line(word, 60),
                       meant.empty() ? otherwise : fmt::format("did you mean {}?", meant));
  };
  const CLI::App* command = &app;
  for (const std::string& word : words) {
    if (word == "--") break;
    if (word.starts_with("--")) {
      const std::string name = word.substr(0, word.find('='));
      if (command->get_option_no_throw(name) != nullptr) continue;
      std::vector<std::string> known;
      for (const OptionText& option : options_of(*command))
        known.insert(known.end(), option.names.begin(), option.names.end());
      return unknown("option", name, known, fmt::format("see {} --help", full_name(*command)));
    }
    const auto all = command->get_subcommands({});
    if (all.empty() || word.starts_with('-')) continue;
    const CLI::App& next = command_of(*command, {word});
    if (&next == command) {
      std::vector<std::string> known;
      for (const CLI::App* below : commands_of(*command)) known.push_back(below->get_name());
      return unknown("command", word, known, fmt::format("there are {}", fmt::join(known, ", ")));
    }
    command = &next;
  }
  return "";
}

}  // namespace grainlaw::app
