#include "app/report/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <vector>

#include "app/report/table_cells.hpp"
#include "model/density_curves.hpp"

namespace grainlaw::app::report {
namespace {

std::string status_words(Status status) {
  switch (status) {
    case Status::fitted:
      return "fitted";
    case Status::fixed:
      return "fixed";
    case Status::tied:
      return "tied";
    case Status::at_bound:
      return "at bound";
    case Status::not_identified:
      break;
  }
  return "not identified";
}

/// "14" as it is, a formula with its symbols.
Text equation_text(const std::string& equation) {
  return equation.find_first_not_of("0123456789") == std::string::npos ? plain(equation) : paper_symbol(equation);
}

}  // namespace

std::string estimate_text(const Estimate& estimate) {
  if (estimate.status == Status::not_identified) return "not identified";
  const std::string value = with_error(estimate.value, estimate.standard_error);
  if (estimate.status == Status::fitted) return value;
  return value + " (" + status_words(estimate.status) + ")";
}

Table parameter_comparison(const CalibratedLaw& law) {
  Table table;
  table.caption = "Parameters of the law: ours and published (Imole et al. 2013, Tables 2 and 3)";
  table.source = "parameters.json";
  table.columns = {words(plain("parameter")),
                   symbol(plain("symbol")),
                   symbol(plain("Eq.")),
                   quantity(plain("ours ± standard error")),
                   quantity(plain("95 % interval")),
                   quantity(plain("published")),
                   quantity(plain("difference")),
                   words(plain("note"))};
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const Estimate& estimate = law.estimates[i];
    const bool known = estimate.status != Status::not_identified;
    const double published = info.published.value_or(kUndefined);
    table.rows.push_back(
        {plain(info.name), paper_symbol(info.symbol), equation_text(info.equation), plain(estimate_text(estimate)),
         plain(interval_text(estimate.value, estimate.half_width())), number(published, 5),
         plain(percent_difference(known ? estimate.value : kUndefined, published)), plain(estimate.note)});
  }
  return table;
}

Table curve_comparison(const CalibratedLaw& law, CurveGroup which) {
  const auto shown = [&](const DensityCurve& curve) {
    return std::string_view(curve.quantity).starts_with("steady_") == (which == CurveGroup::steady_state);
  };
  Table table;
  table.caption = which == CurveGroup::law
                      ? "The law's curves: ours, and the difference from the published curve in brackets"
                      : "Steady state of shear (not read by the law), likewise";
  table.source = "parameters.json";
  table.columns = {quantity(notation("{ν}"))};
  std::map<double, std::vector<Text>> rows;
  for (const CurvePoint& point :
       curve_points(law.parameters, published_parameters(), law.range.nu_min, law.range.nu_max)) {
    if (!shown(*point.curve)) continue;
    const bool known = has_values(law, *point.curve);
    std::vector<Text>& row = rows[point.nu];
    if (row.empty()) row.push_back(plain(fixed(point.nu, 2)));
    row.push_back(
        plain(known ? significant_padded(point.ours, 4) + " (" + percent_difference(point.ours, point.published) + ")"
                    : "not identified"));
  }
  for (const DensityCurve& curve : density_curves()) {
    if (shown(curve)) table.columns.push_back(quantity(notation(curve.symbol)));
  }
  for (auto& [nu, row] : rows) table.rows.push_back(std::move(row));
  return table;
}

std::string parameter_summary(const CalibratedLaw& law) {
  std::string text = fmt::format("{:<28} {:<14} {:>26} {:>22} {:>10}\n", "parameter", "symbol", "ours ± standard error",
                                 "95 % interval", "published");
  text += std::string(104, '-') + "\n";
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const std::string published = info.published ? significant(*info.published, 5) : kNoNumber;
    const Estimate& estimate = law.estimates[i];
    text += fmt::format("{:<28} {:<14} {:>26} {:>22} {:>10}\n", info.name, info.symbol, estimate_text(estimate),
                        interval_text(estimate.value, estimate.half_width()), published);
  }
  return text;
}

}  // namespace grainlaw::app::report
