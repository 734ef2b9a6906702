#include "app/report/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/report/dem_series.hpp"
#include "app/report/number_text.hpp"

namespace grainlaw::app::report {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Text number(double value, int digits = 4) { return plain(significant(value, digits)); }

std::string status_words(fit::Status status) {
  switch (status) {
    case fit::Status::fitted: return "fitted";
    case fit::Status::fixed: return "fixed";
    case fit::Status::tied: return "tied";
    case fit::Status::at_bound: return "at bound";
    case fit::Status::not_identified: break;
  }
  return "not identified";
}

double percent(double part, double whole) { return 100 * part / whole; }

/// Largest defined value of `of` over the rows of `test`; NaN when there is none.
template <class Function>
double largest(const TestRecord& test, const Function& of) {
  double result = kNone;
  for (const Observation& row : test.rows) {
    const double value = of(row);
    if (std::isfinite(value) && !(value <= result)) result = value;
  }
  return result;
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
  table.columns = {{plain("parameter"), false}, {plain("symbol"), false}, {plain("Eq."), false},
                   {plain("ours ± standard error"), true}, {plain("published"), true}, {plain("difference"), true},
                   {plain("note"), false}};
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const fit::Estimate& estimate = calibration.estimates[i];
    const bool known = estimate.status != fit::Status::not_identified;
    const double published = info.published.value_or(kNone);
    table.rows.push_back({plain(info.name), paper_symbol(info.symbol), plain(info.equation),
                          plain(estimate_text(estimate)), number(published, 5),
                          plain(percent_difference(known ? estimate.value : kNone, published)), plain(estimate.note)});
  }
  return table;
}

Table curve_comparison(const fit::Calibration& calibration) {
  using P = LawParameters<double>;
  struct Curve {
    const char* symbol;
    double (*of)(const P&, double nu);
  };
  static constexpr std::array<Curve, 7> curves{
      {{"{C}*", [](const P& p, double nu) { return p.isotropic.coordination.C_star(nu); }},
       {"{φ}_{r}", [](const P& p, double nu) { return p.isotropic.rattlers.fraction(nu, p.isotropic.coordination.nu_c); }},
       {"{P}*", [](const P& p, double nu) { return p.isotropic.P_star(nu); }},
       {"{s}_{max}", [](const P& p, double nu) { return p.stress_ratio_max.value(nu, p.shear_nu_c); }},
       {"{β}_{s}", [](const P& p, double nu) { return p.stress_rate.value(nu, p.shear_nu_c); }},
       {"{F}_{max}", [](const P& p, double nu) { return p.fabric_max.value(nu, p.shear_nu_c); }},
       {"{β}_{F}", [](const P& p, double nu) { return p.fabric_rate.value(nu, p.shear_nu_c); }}}};
  Table table;
  table.caption = "The law's curves: ours, and the difference from the published curve in brackets";
  table.source = "parameters.json";
  table.columns = {{notation("{ν}"), true}};
  for (const Curve& c : curves) table.columns.push_back({notation(c.symbol), true});
  const P published = published_parameters();
  const double step = 0.02, slack = 1e-9;
  for (double k = std::ceil((calibration.nu_min - slack) / step); k * step <= calibration.nu_max + slack; ++k) {
    const double nu = k * step;
    std::vector<Text> row{plain(fixed(nu, 2))};
    for (const Curve& c : curves) {
      const double ours = c.of(calibration.parameters, nu);
      row.push_back(plain(significant(ours, 4) + " (" + percent_difference(ours, c.of(published, nu)) + ")"));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table stage_table(const fit::Calibration& calibration) {
  Table table;
  table.caption = "Stages of the fit";
  table.source = "calibration.json";
  table.columns = {{plain("stage"), false}, {plain("free"), true}, {plain("residuals"), true}, {plain("iterations"), true},
                   {plain("cost at start"), true}, {plain("cost at end"), true}, {plain("seconds"), true},
                   {plain("window"), false}, {plain("termination"), false}};
  for (const fit::Stage& stage : calibration.stages) {
    table.rows.push_back({plain(stage.name), plain(std::to_string(stage.free_parameters)),
                          plain(std::to_string(stage.residuals)), plain(std::to_string(stage.iterations)),
                          number(stage.initial_cost), number(stage.final_cost), number(stage.seconds, 2),
                          plain(stage.window), plain(stage.termination)});
  }
  return table;
}

Table residual_table(const fit::Calibration& calibration) {
  Table table;
  table.caption = "Misfit of the coupled fit per test: model minus DEM";
  table.source = "calibration.json";
  table.columns = {{plain("test"), false}, {plain("quantity"), false}, {plain("rows"), true}, {plain("left out"), true},
                   {plain("RMS"), true}, {plain("bias"), true}, {plain("RMS/max|DEM| [%]"), true},
                   {plain("bias/max|DEM| [%]"), true}};
  for (const fit::Stage& stage : calibration.stages) {
    if (stage.name != "evolution") continue;
    for (const fit::TestResidual& r : stage.tests) {
      table.rows.push_back({plain(r.test), plain(r.quantity), plain(std::to_string(r.rows)),
                            plain(std::to_string(r.rows_excluded)), number(r.rms, 3), number(r.bias, 3),
                            plain(fixed(percent(r.rms, r.max_abs_data), 2)), plain(fixed(percent(r.bias, r.max_abs_data), 2))});
    }
  }
  return table;
}

Table prediction_table(const PredictionCase& prediction) {
  Table table;
  table.caption = prediction.name + ": prediction minus DEM";
  table.source = "predictions/" + prediction.name + "/comparison.json";
  table.columns = {{plain("model"), false}, {plain("start"), false}, {plain("DEM run"), false}, {plain("quantity"), false},
                   {plain("bias"), true}, {plain("RMS"), true}, {plain("RMS/max|DEM| [%]"), true}, {plain("largest"), true},
                   {notation("at {ε}_{dev}"), true}, {notation("at {ν}"), true}};
  for (const ComparisonEntry& entry : prediction.comparisons) {
    const predict::QuantityComparison& v = entry.values;
    table.rows.push_back({plain(entry.model), plain(entry.initial), plain(entry.test), plain(v.quantity), number(v.bias, 3),
                          number(v.rms, 3), plain(fixed(100 * v.normalised_rms, 2)), number(v.largest, 3),
                          number(v.largest_at_eps_dev, 3), number(v.largest_at_nu, 3)});
  }
  return table;
}

Table run_table(const ReportInput& input) {
  Table table;
  table.caption = "Runs of the data set";
  table.source = "dataset/";
  table.columns = {{plain("test"), false}, {plain("role"), false}, {plain("path"), false}, {notation("{ν} at start"), true},
                   {plain("seed"), true}, {notation("{N}"), true}, {plain("rows"), true}, {plain("steps"), true},
                   {plain("seconds"), true}, {notation("median {E}_{kin}/{E}_{pot}"), true},
                   {plain("largest |energy residual|"), true}, {notation("largest {I}"), true}};
  for (const TestRecord& test : input.tests) {
    const auto cost = std::find_if(input.costs.begin(), input.costs.end(), [&](const RunCost& c) { return c.name == test.name; });
    const bool known = cost != input.costs.end();
    std::vector<double> ratios;
    for (const Observation& row : test.rows) {
      const double ratio = row.E_kin / row.E_pot;
      if (std::isfinite(ratio)) ratios.push_back(ratio);
    }
    double median = kNone;
    if (!ratios.empty()) {
      const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
      std::nth_element(ratios.begin(), middle, ratios.end());
      median = *middle;
    }
    table.rows.push_back(
        {plain(test.name), plain(to_string(test.role)), plain(kind_of(test.path)), plain(fixed(test.path.nu, 3)),
         plain(std::to_string(test.packing.seed)), plain(std::to_string(test.packing.particles)),
         plain(std::to_string(test.rows.size())), plain(known ? std::to_string(cost->steps) : kNoNumber),
         plain(known ? significant(cost->seconds, 3) : kNoNumber), number(median, 2),
         number(largest(test, [](const Observation& row) { return std::abs(row.energy_residual); }), 2),
         number(largest(test, [](const Observation& row) { return row.inertial_number; }), 2)});
  }
  return table;
}

Table provenance_table(const ReportInput& input) {
  Table table;
  table.caption = "Where this comes from";
  table.columns = {{plain("what"), false}, {plain("value"), false}};
  for (const Fact& fact : input.provenance) table.rows.push_back({plain(fact.what), plain(fact.value)});
  return table;
}

std::string parameter_summary(const fit::Calibration& calibration) {
  std::string text = fmt::format("{:<28} {:<14} {:>26} {:>10}\n", "parameter", "symbol", "ours ± standard error", "published");
  text += std::string(81, '-') + "\n";
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const std::string published = info.published ? significant(*info.published, 5) : kNoNumber;
    text += fmt::format("{:<28} {:<14} {:>26} {:>10}\n", info.name, info.symbol, estimate_text(calibration.estimates[i]),
                        published);
  }
  return text;
}

}  // namespace grainlaw::app::report
