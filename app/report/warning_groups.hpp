#pragma once
// Every warning of the runs, the fit and the predictions, grouped by its cause and counted once, with what it costs.

#include <string>
#include <vector>

#include "app/report/table.hpp"
#include "chain/report_input.hpp"

namespace grainlaw::app::report {

struct WarningGroup {
  std::string cause;
  std::string consequence;              ///< what it means, or what the limit costs
  std::string example;                  ///< the worst, or the first one
  std::vector<std::string> where = {};  ///< tests, predictions or files, each once
};

/// Commonest last: files that do not belong together, the fit, predictions, runs. Of inertia only rows of jammed packings count (six
/// contacts per sphere that bears load): they are counted from the series, as earlier programs warned of all rows.
std::vector<WarningGroup> warning_groups(const chain::ReportInput& input);

Table warning_table(const std::vector<WarningGroup>& groups);

}  // namespace grainlaw::app::report
