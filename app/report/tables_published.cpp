#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/table_cells.hpp"
#include "app/report/tables.hpp"
#include "model/density_curves.hpp"

namespace grainlaw::app::report {
namespace {

std::size_t count(const std::vector<fit::Verdict>& verdicts, bool of_parameters, const std::string& verdict) {
  return static_cast<std::size_t>(std::count_if(verdicts.begin(), verdicts.end(), [&](const fit::Verdict& v) {
    return v.is_parameter == of_parameters && v.verdict == verdict;
  }));
}

/// The paper's symbol of a parameter or curve; its name where there is none.
Text symbol_of(const fit::Verdict& v) {
  if (v.is_parameter) return paper_symbol(parameter_table()[parameter_index(v.quantity)].symbol);
  for (const DensityCurve& curve : density_curves()) {
    if (curve.quantity == v.quantity) return notation(curve.symbol);
  }
  return plain(v.quantity);
}

}  // namespace

Table verdict_table(const std::vector<fit::Verdict>& verdicts, bool of_parameters) {
  Table table;
  table.caption = fmt::format(
      "{} against the published: {} agree, {} differ, {} have no error. Distance: difference over the standard error "
      "of a difference between our mean and one other packing",
      of_parameters ? "Parameters of Tables 2 and 3" : "Curves over density", count(verdicts, of_parameters, "agrees"),
      count(verdicts, of_parameters, "differs"), count(verdicts, of_parameters, "no error"));
  table.source = "calibration.json";
  table.columns = {words(plain("mode")), words(plain("quantity")), symbol(plain("symbol"))};
  if (!of_parameters) table.columns.push_back(quantity(notation("{ν}")));
  for (const char* heading : {"ours ± standard error", "published", "distance"})
    table.columns.push_back(quantity(plain(heading)));
  table.columns.push_back(words(plain("verdict")));
  for (const fit::Verdict& v : verdicts) {
    if (v.is_parameter != of_parameters) continue;
    std::vector<Text> row{plain(v.mode), plain(v.quantity), symbol_of(v)};
    if (!of_parameters) row.push_back(plain(fixed(v.nu, 2)));
    row.push_back(plain(with_error(v.ours, v.standard_error)));
    row.push_back(number(v.published));
    row.push_back(plain(fixed(v.distance, 1)));
    row.push_back(plain(v.verdict));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table claim_table(const std::vector<fit::Claim>& claims) {
  const auto number_of = [&](const char* verdict) {
    return std::count_if(claims.begin(), claims.end(), [&](const fit::Claim& c) { return c.verdict == verdict; });
  };
  Table table;
  table.caption = fmt::format(
      "What the paper says beyond Tables 2 and 3: {} agree, {} differ, {} are undecided. Without a published value the "
      "sign is said: ours above zero",
      number_of("agrees"), number_of("differs"), number_of("undecided"));
  table.source = "calibration.json";
  table.columns = {words(plain("where")),        words(plain("what")),
                   quantity(notation("{ν}")),    quantity(plain("ours ± standard error")),
                   quantity(plain("published")), words(plain("verdict"))};
  for (const fit::Claim& c : claims) {
    table.rows.push_back({plain(c.where), plain(c.statement), plain(std::isnan(c.nu) ? "" : fixed(c.nu, 3)),
                          plain(with_error(c.ours, c.standard_error)),
                          std::isnan(c.published) ? plain("> 0") : number(c.published), plain(c.verdict)});
  }
  return table;
}

Table jamming_table(const std::vector<fit::Verdict>& verdicts) {
  Table table;
  table.caption =
      "Jamming densities by mode, from the coordination number (Eq. 11) and from the pressure (Eq. 14): the paper "
      "finds ISO > UNI > D2 = D3";
  table.source = "calibration.json";
  table.columns = {words(plain("mode")), quantity(notation("{ν}_{c} of {C}*")), quantity(plain("published")),
                   quantity(notation("{ν}_{c} of {P}*")), quantity(plain("published"))};
  for (const char* mode : {"ISO", "UNI", "D2", "D3"}) {
    std::vector<Text> row{plain(mode)};
    for (const char* group : {"coordination.nu_c", "pressure.nu_c"}) {
      const auto at = std::find_if(verdicts.begin(), verdicts.end(), [&](const fit::Verdict& v) {
        return v.is_parameter && v.mode == mode && v.quantity.ends_with(group);
      });
      if (at == verdicts.end()) break;
      row.push_back(plain(with_error(at->ours, at->standard_error)));
      row.push_back(number(at->published));
    }
    if (row.size() == table.columns.size()) table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace grainlaw::app::report
