#include "app/report/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/report/table_cells.hpp"

namespace grainlaw::app::report {
namespace {

std::string status_words(fit::Status status) {
  switch (status) {
    case fit::Status::fitted:
      return "fitted";
    case fit::Status::fixed:
      return "fixed";
    case fit::Status::tied:
      return "tied";
    case fit::Status::at_bound:
      return "at bound";
    case fit::Status::not_identified:
      break;
  }
  return "not identified";
}

/// "14" as it is, a formula with its symbols.
Text equation_text(const std::string& equation) {
  return equation.find_first_not_of("0123456789") == std::string::npos ? plain(equation) : paper_symbol(equation);
}

}  // namespace

std::string estimate_text(const fit::Estimate& estimate) {
  if (estimate.status == fit::Status::not_identified) return "not identified";
  const std::string value = with_error(estimate.value, estimate.standard_error);
  if (estimate.status == fit::Status::fitted) return value;
  return value + " (" + status_words(estimate.status) + ")";
}

Table parameter_comparison(const fit::Calibration& calibration) {
  Table table;
  table.caption = "Parameters of the law: ours and published (Imole et al. 2013, Tables 2 and 3)";
  table.source = "parameters.json";
  table.columns = {words(plain("parameter")),    symbol(plain("symbol")),
                   symbol(plain("Eq.")),         quantity(plain("ours ± standard error")),
                   quantity(plain("published")), quantity(plain("difference")),
                   words(plain("note"))};
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const fit::Estimate& estimate = calibration.estimates[i];
    const bool known = estimate.status != fit::Status::not_identified;
    const double published = info.published.value_or(kUndefined);
    table.rows.push_back({plain(info.name), paper_symbol(info.symbol), equation_text(info.equation),
                          plain(estimate_text(estimate)), number(published, 5),
                          plain(percent_difference(known ? estimate.value : kUndefined, published)),
                          plain(estimate.note)});
  }
  return table;
}

namespace {

/// A curve of the law over density, and the groups of parameters that it reads.
struct DensityCurve {
  const char* symbol;
  std::vector<const char*> groups;
  double (*of)(const LawParameters<double>&, double nu);
};

const std::vector<DensityCurve>& density_curves() {
  using P = const LawParameters<double>&;
  static const std::vector<DensityCurve> curves{
      {"{C}*", {"coordination"}, [](P p, double nu) { return p.isotropic.coordination.C_star(nu); }},
      {"{φ}_{r}",
       {"rattlers", "coordination"},
       [](P p, double nu) { return p.isotropic.rattlers.fraction(nu, p.isotropic.coordination.nu_c); }},
      {"{P}*", {"pressure", "coordination", "rattlers"}, [](P p, double nu) { return p.isotropic.P_star(nu); }},
      {"{s}_{max}", {"stress_ratio_max"}, [](P p, double nu) { return p.stress_ratio_max.value(nu, p.shear_nu_c); }},
      {"{β}_{s}", {"stress_rate"}, [](P p, double nu) { return p.stress_rate.value(nu, p.shear_nu_c); }},
      {"{F}_{max}", {"fabric_max"}, [](P p, double nu) { return p.fabric_max.value(nu, p.shear_nu_c); }},
      {"{β}_{F}", {"fabric_rate"}, [](P p, double nu) { return p.fabric_rate.value(nu, p.shear_nu_c); }}};
  return curves;
}

}  // namespace

Table curve_comparison(const fit::Calibration& calibration) {
  Table table;
  table.caption = "The law's curves: ours, and the difference from the published curve in brackets";
  table.source = "parameters.json";
  table.columns = {quantity(notation("{ν}"))};
  for (const DensityCurve& c : density_curves()) table.columns.push_back(quantity(notation(c.symbol)));
  const LawParameters<double> published = published_parameters();
  const double step = 0.02, slack = 1e-9;
  for (double k = std::ceil((calibration.nu_min - slack) / step); k * step <= calibration.nu_max + slack; ++k) {
    const double nu = k * step;
    std::vector<Text> row{plain(fixed(nu, 2))};
    for (const DensityCurve& c : density_curves()) {
      const bool known = std::all_of(c.groups.begin(), c.groups.end(),
                                     [&](const char* group) { return has_values(calibration, group); });
      const double ours = known ? c.of(calibration.parameters, nu) : kUndefined;
      row.push_back(plain(known
                              ? significant_padded(ours, 4) + " (" + percent_difference(ours, c.of(published, nu)) + ")"
                              : "not identified"));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string parameter_summary(const fit::Calibration& calibration) {
  std::string text =
      fmt::format("{:<28} {:<14} {:>26} {:>10}\n", "parameter", "symbol", "ours ± standard error", "published");
  text += std::string(81, '-') + "\n";
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const std::string published = info.published ? significant(*info.published, 5) : kNoNumber;
    text += fmt::format("{:<28} {:<14} {:>26} {:>10}\n", info.name, info.symbol,
                        estimate_text(calibration.estimates[i]), published);
  }
  return text;
}

}  // namespace grainlaw::app::report
