// grainlaw report DIR -o report.html: one page about a calibration and its predictions; --json: its numbers.

#include "app/report/report.hpp"
#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "model/files/json_document.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::app {

Task declare_report(CLI::App& command) {
  const auto folder = std::make_shared<std::filesystem::path>(), html = std::make_shared<std::filesystem::path>(),
             other = std::make_shared<std::filesystem::path>();
  add_value(command, "DIR", *folder, "DIR", "folder of a calibration")->required();
  add_value(command, "-o,--output", *html, "FILE",
            "file of the page, e.g. report.html, or - for standard output; not needed with --json");
  add_value(command, "--compare", *other, "DIR", "folder of another calibration, set beside this one");
  return [folder, html, other](Session& session) {
    if (html->empty() && !session.json)
      throw InvalidInput("report: -o FILE is missing, the page's file; or --json for its numbers on standard output");
    const bool to_output = *html == "-";
    if (to_output && session.json)
      throw InvalidInput("report: -o - and --json both write to standard output; leave one of them out");
    if (!html->empty()) write_report(*folder, *html, *other);
    if (to_output) return ExitCode::ok;
    print_result(session.json ? json_text(report_json(*folder, *other))
                              : summary_table(*folder) + "\n" + html->string() + "\n");
    return ExitCode::ok;
  };
}

}  // namespace grainlaw::app
