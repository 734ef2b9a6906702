#include "app/report/report.hpp"

#include "app/report/report_page.hpp"
#include "app/report/tables.hpp"
#include "model/files/durable_file.hpp"

namespace grainlaw::app {

void write_report(const std::filesystem::path& dir, const std::filesystem::path& html) {
  write_durably(html, report::page_html(report::make_page(report::read_report_input(dir))));
}

std::string summary_table(const std::filesystem::path& dir) {
  return report::parameter_summary(report::read_fitted_parameters(dir));
}

}  // namespace grainlaw::app
