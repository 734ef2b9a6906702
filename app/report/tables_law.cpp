// The law: parameters, curves and what they say, ours beside what Imole et al. (2013) published.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "app/report/series.hpp"
#include "app/report/tables.hpp"

namespace grainlaw::app::report {
namespace {

using enum Content;
using fit::Claim, fit::Verdict;

struct Parameter {
  const ParameterInfo& info;
  const Estimate& estimate;
  bool says_nothing;

  bool is_known() const { return estimate.status != Status::not_identified; }
  double published() const { return info.published.value_or(kUndefined); }
};

std::vector<Parameter> parameters_of(const CalibratedLaw& law) {
  std::vector<Parameter> parameters;
  for (std::size_t i = 0; i < kParameterCount; ++i)
    parameters.push_back({parameter_table()[i], law.estimates[i], says_nothing(law, i)});
  return parameters;
}

/// "8.27 ± 0.31", "0.6653 (fixed)", "not identified".
/// Where it says nothing, the note that says so.
std::string interval_of(const Parameter& parameter) {
  if (parameter.says_nothing) return parameter.estimate.note;
  return interval_text(parameter.estimate.value, parameter.estimate.half_width());
}

/// "14" as it is, a formula with its symbols.
Text equation_text(const std::string& equation) {
  return equation.find_first_not_of("0123456789") == std::string::npos ? plain(equation) : paper_symbol(equation);
}

/// The paper's symbol of a parameter or curve; its name where there is none.
Text symbol_of(const Verdict& v) {
  if (!v.nu) return paper_symbol(parameter_table()[parameter_index(v.quantity)].symbol);
  for (const DensityCurve& curve : density_curves()) {
    if (curve.quantity == v.quantity) return notation(curve.symbol);
  }
  return plain(v.quantity);
}

/// How many verdicts or claims say `verdict`.
template <class Judged>
std::ptrdiff_t count(const std::vector<Judged>& all, const char* verdict) {
  return std::count_if(all.begin(), all.end(), [&](const Judged& judged) { return judged.verdict == verdict; });
}

/// A mode's jamming densities; both are there.
struct Jamming {
  const char* mode;
  const Verdict *of_coordination, *of_pressure;
};

}  // namespace

Cell estimate_cell(const Estimate& estimate) {
  std::string status = to_string(estimate.status);
  std::replace(status.begin(), status.end(), '_', ' ');
  if (estimate.status == Status::not_identified) return status;
  const Cell value = measured(estimate.value, estimate.standard_error);
  return estimate.status == Status::fitted ? value : Cell(to_plain(value.text) + " (" + status + ")", value.value);
}

Cell difference_cell(double ours, double reference) {
  return {percent_difference(ours, reference), 100 * (ours - reference) / std::abs(reference)};
}

Table parameter_comparison(const CalibratedLaw& law) {
  const auto difference = [](const Parameter& p) {
    return difference_cell(p.is_known() ? p.estimate.value : kUndefined, p.published());
  };
  Table table = table_of("Parameters of the law: ours and published (Imole et al. 2013, Tables 2 and 3)",
                         "parameters.json", parameters_of(law),
                         {{"parameter", words, [](auto& p) { return p.info.name; }},
                          {"symbol", symbol, [](auto& p) { return paper_symbol(p.info.symbol); }},
                          {"Eq.", symbol, [](auto& p) { return equation_text(p.info.equation); }},
                          {"ours ± standard error", number, [](auto& p) { return estimate_cell(p.estimate); }},
                          {"95 % interval", number, interval_of},
                          {"published", number, [](auto& p) { return digits(p.published(), 5); }},
                          {"difference", number, difference}});
  for (const Parameter& p : parameters_of(law)) table.notes.push_back(p.estimate.note);
  return table;
}

Table forest(const CalibratedLaw& law, Forest which) {
  const auto scale = [=](const Parameter& p) {
    return which == Forest::own ? std::abs(p.estimate.value) : std::abs(p.published());
  };
  const auto is_density = [](const Parameter& p) { return std::string_view(p.info.name).ends_with("nu_c"); };
  std::vector<Parameter> shown;
  for (const Parameter& p : parameters_of(law)) {
    if (!p.is_known()) continue;
    const bool published = std::isfinite(p.published()) && p.published() != 0;
    const Forest its = is_density(p) ? Forest::densities : published ? Forest::ratios : Forest::own;
    if (its == which && (its == Forest::densities || scale(p) > 0)) shown.push_back(p);
  }
  const auto bar = [=](const Parameter& p) {
    const double unit = which == Forest::densities ? 1 : scale(p), half = p.estimate.half_width();
    Bar drawn{(p.estimate.value - half) / unit, p.estimate.value / unit, (p.estimate.value + half) / unit,
              which == Forest::own ? kUndefined : p.published() / unit};
    Cell cell(fmt::format("ours {}, published {}", significant(p.estimate.value), significant(p.published())),
              drawn.value);
    cell.bar = drawn;
    return cell;
  };
  std::vector<ColumnOf<Parameter>> columns{
      {"", symbol, [](auto& p) { return paper_symbol(p.info.symbol); }},
      {"parameter", words, [](auto& p) { return p.info.name; }},
      {"", symbol, bar},
      {"ours ± standard error", number, [](auto& p) { return estimate_cell(p.estimate); }}};
  if (which != Forest::own) columns.push_back({"published", number, [](auto& p) { return digits(p.published(), 5); }});
  Table table =
      table_of(which == Forest::densities ? "Jamming densities: ours with 95 % interval (dot), published (bar)"
               : which == Forest::ratios  ? "Parameters over the published value: ours with 95 % interval (dot, at the "
                                            "end where it lies beyond), published (bar)"
                                          : "Parameters that the paper does not have, over their own value",
               "parameters.json", shown, columns);
  // to both ends whatever is drawn, but no farther than none and twice the value
  table.bar_from = 1e300, table.bar_to = -1e300;
  for (const auto& row : table.rows) {
    for (const double x : {row[2].bar->lower, row[2].bar->value, row[2].bar->upper, row[2].bar->reference}) {
      if (!std::isfinite(x)) continue;
      table.bar_from = std::min(table.bar_from, x);
      table.bar_to = std::max(table.bar_to, x);
    }
  }
  if (which != Forest::densities) {
    table.bar_from = std::clamp(table.bar_from, 0.0, 0.8);
    table.bar_to = std::clamp(table.bar_to, 1.2, 2.0);
  }
  table.columns[2].heading = notation(fmt::format("{}{} … {}",
                                                  which == Forest::densities ? "{ν} = "
                                                  : which == Forest::ratios  ? "over published: "
                                                                             : "over its own: ",
                                                  significant(table.bar_from, 3), significant(table.bar_to, 3)));
  return table;
}

Table curve_comparison(const CalibratedLaw& law, CurveGroup which) {
  const LawParameters<double>&ours = law.parameters, published = published_parameters();
  std::vector<ColumnOf<double>> columns{{"{ν}", number, [](double nu) { return decimals(nu, 2); }}};
  for (const DensityCurve& shown : density_curves()) {
    if (std::string_view(shown.quantity).starts_with("steady_") != (which == CurveGroup::steady_state)) continue;
    const bool known = has_values(law, shown);
    columns.push_back({shown.symbol, number, [&, known](double nu) -> Cell {
                         if (!known) return "not identified";
                         const double value = shown.of(ours, nu);
                         const std::string difference = percent_difference(value, shown.of(published, nu));
                         return {significant_padded(value, 4) + " (" + difference + ")", value};
                       }});
  }
  std::vector<double> densities;
  for (const CurvePoint& point : curve_points(ours, published, law.range.nu_min, law.range.nu_max)) {
    if (point.curve == &density_curves().front()) densities.push_back(point.nu);
  }
  return table_of(which == CurveGroup::law
                      ? "The law's curves: ours, and the difference from the published curve in brackets"
                      : "Steady state of shear (not read by the law), likewise",
                  "parameters.json", densities, columns);
}

Table verdict_table(const std::vector<fit::Verdict>& verdicts, bool of_parameters) {
  std::vector<Verdict> shown;
  std::ranges::copy_if(verdicts, std::back_inserter(shown), [&](const Verdict& v) { return !v.nu == of_parameters; });
  std::vector<ColumnOf<Verdict>> columns{
      {"mode", words, &Verdict::mode},
      {"quantity", words, &Verdict::quantity},
      {"symbol", symbol, symbol_of},
      {"{ν}", number, [](auto& v) { return decimals(*v.nu, 2); }},
      {"ours ± standard error", number, [](auto& v) { return measured(v.ours, v.standard_error); }},
      {"published", number, [](auto& v) { return digits(v.published); }},
      {"distance", number, [](auto& v) { return decimals(v.distance, 1); }},
      {"range", number, [](auto& v) { return significant(v.range, 2); }},
      {"what matters", number, [](auto& v) { return significant(v.matters, 2); }},
      {"verdict", words, &Verdict::verdict}};
  if (of_parameters) columns.erase(columns.begin() + 3);
  return table_of(
      fmt::format("{} against the published: {} agree, {} differ, {} are inconclusive, {} have no error. Distance: "
                  "difference over the standard error of a difference between our mean and one other packing; range: "
                  "what chance may do, 95 %; inconclusive: within a range that is wider than what matters",
                  of_parameters ? "Parameters of Tables 2 and 3" : "Curves over density", count(shown, "agrees"),
                  count(shown, "differs"), count(shown, "inconclusive"), count(shown, "no error")),
      "calibration.json", shown, columns);
}

Table claim_table(const std::vector<fit::Claim>& claims) {
  return table_of(
      fmt::format("What the paper says beyond Tables 2 and 3: {} agree, {} differ, {} are undecided or inconclusive. "
                  "Without a published value the sign is said: ours above zero. Identities are no evidence",
                  count(claims, "agrees"), count(claims, "differs"),
                  count(claims, "undecided") + count(claims, "inconclusive")),
      "calibration.json", claims,
      {{"where", words, &Claim::where},
       {"what", words, &Claim::statement},
       {"{ν}", number, [](auto& c) { return std::isnan(c.nu) ? "" : decimals(c.nu, 3); }},
       {"ours ± standard error", number, [](auto& c) { return measured(c.ours, c.standard_error); }},
       {"published", number, [](auto& c) { return std::isnan(c.published) ? "> 0" : digits(c.published); }},
       {"verdict", words, &Claim::verdict}});
}

Table jamming_table(const std::vector<fit::Verdict>& verdicts) {
  std::vector<Jamming> modes;
  for (const char* mode : {"ISO", "UNI", "D2", "D3"}) {
    const auto verdict_on = [&](const char* parameter) -> const Verdict* {
      const auto at = std::ranges::find_if(
          verdicts, [&](const Verdict& v) { return !v.nu && v.mode == mode && v.quantity.ends_with(parameter); });
      return at == verdicts.end() ? nullptr : &*at;
    };
    const Jamming jamming{mode, verdict_on("coordination.nu_c"), verdict_on("pressure.nu_c")};
    if (jamming.of_coordination != nullptr && jamming.of_pressure != nullptr) modes.push_back(jamming);
  }
  const auto ours = [](const Verdict& v) { return measured(v.ours, v.standard_error); };
  return table_of(
      "Jamming densities by mode, from the coordination number (Eq. 11) and from the pressure (Eq. 14): the paper "
      "finds ISO > UNI > D2 = D3",
      "calibration.json", modes,
      {{"mode", words, &Jamming::mode},
       {"{ν}_{c} of {C}*", number, [=](auto& jamming) { return ours(*jamming.of_coordination); }},
       {"published", number, [](auto& jamming) { return digits(jamming.of_coordination->published); }},
       {"{ν}_{c} of {P}*", number, [=](auto& jamming) { return ours(*jamming.of_pressure); }},
       {"published", number, [](auto& jamming) { return digits(jamming.of_pressure->published); }}});
}

std::string parameter_summary(const CalibratedLaw& law) {
  constexpr const char* kRow = "{:<25} {:>23} {:>20} {:>9}\n";  // 80 columns
  std::string text =
      fmt::format(fmt::runtime(kRow), "parameter", "ours ± standard error", "95 % interval", "published") +
      std::string(80, '-') + "\n";
  for (const Parameter& p : parameters_of(law)) {
    text += fmt::format(fmt::runtime(kRow), p.info.name, to_plain(estimate_cell(p.estimate).text),
                        p.says_nothing ? "not determined" : interval_of(p), significant(p.published(), 5));
  }
  return text;
}

}  // namespace grainlaw::app::report
