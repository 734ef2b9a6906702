#include "app/terminal/manual.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/terminal/help.hpp"
#include "model/files/execution.hpp"
#include "model/files/output.hpp"

namespace grainlaw::app {
namespace {

/// Text as roff takes it: no escapes, no requests, dashes that are typed.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string page_name(const CLI::App& command) {
  std::string name = full_name(command);
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string options_section(const CLI::App& command) {
  std::string text;
  for (const bool positional : {true, false}) {
    std::string section;
    for (const OptionText& option : options_of(command)) {
      if (option.positional != positional) continue;
      std::vector<std::string> names;
      for (const std::string& name : option.names) names.push_back(fmt::format("\\fB{}\\fR", roff(name)));
      section += fmt::format(".TP\n{}{}{}\n{}{}\n", fmt::join(names, ", "),
                             positional || option.value.empty() ? "" : fmt::format(" \\fI{}\\fR", roff(option.value)),
                             option.many ? "..." : "", roff(option.description),
                             option.required && !positional ? " (required)" : "");
    }
    if (!section.empty()) text += fmt::format(".SH {}\n{}", positional ? "ARGUMENTS" : "OPTIONS", section);
  }
  return text;
}

std::string page(const CLI::App& command) {
  std::string title = page_name(command), version = version_text();
  std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return std::toupper(c); });
  std::string text =
      fmt::format(".TH {} 1 \"\" \"{}\" \"User Commands\"\n", roff(title), version.substr(0, version.find(" (")));
  text += fmt::format(".SH NAME\n{} \\- {}\n", roff(page_name(command)), roff(command.get_description()));
  text += fmt::format(".SH SYNOPSIS\n\\fB{}\\fR\n", roff(synopsis(command)));
  std::vector<std::string> related;
  if (command.get_parent() != nullptr) related.push_back(page_name(*command.get_parent()));
  if (const auto below = commands_of(command); !below.empty()) {
    text += ".SH COMMANDS\n";
    for (const CLI::App* each : below) {
      text += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(each->get_name()), roff(each->get_description()));
      related.push_back(page_name(*each));
    }
  }
  text += options_section(command);
  text += fmt::format(".SH EXIT STATUS\n{}\n", roff(command.get_footer()));
  for (std::string& name : related) name = fmt::format("\\fB{}\\fR(1)", roff(name));
  return text + fmt::format(".SH SEE ALSO\n{}\n", fmt::join(related, ",\n"));
}

int write_pages(const CLI::App& command, const std::filesystem::path& folder) {
  write_durably(folder / (page_name(command) + ".1"), page(command));
  int pages = 1;
  for (const CLI::App* below : commands_of(command)) pages += write_pages(*below, folder);
  return pages;
}

}  // namespace

int write_manual(const CLI::App& app, const std::filesystem::path& folder) {
  make_output_folder(folder);
  return write_pages(app, folder);
}

}  // namespace grainlaw::app
