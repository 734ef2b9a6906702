#pragma once
// What stands on the page, in which order.

#include "app/report/page.hpp"
#include "app/report/report_input.hpp"

namespace grainlaw::app::report {

Page make_page(const ReportInput& input);

}  // namespace grainlaw::app::report
