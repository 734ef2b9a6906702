// grainlaw report DIR -o report.html: one page about a calibration and its predictions.

#include "app/report/report.hpp"
#include "app/commands/commands.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw::app {

Task declare_report(CLI::App& command) {
  const auto folder = std::make_shared<std::filesystem::path>(), html = std::make_shared<std::filesystem::path>(),
             other = std::make_shared<std::filesystem::path>();
  command.add_option("DIR", *folder, "folder of a calibration")->required()->type_name("DIR");
  command.add_option("-o,--output", *html, "file of the page, e.g. report.html")->required()->type_name("FILE");
  command.add_option("--compare", *other, "folder of another calibration, set beside this one")->type_name("DIR");
  return [folder, html, other](Session& session) {
    write_report(*folder, *html, *other);
    print_result(session.json ? json_text({{"report", html->string()}})
                              : summary_table(*folder) + "\n" + html->string() + "\n");
    return ExitCode::ok;
  };
}

}  // namespace grainlaw::app
