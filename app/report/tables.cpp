#include "app/report/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "app/report/dem_series.hpp"
#include "app/report/number_text.hpp"

namespace grainlaw::app::report {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TableColumn words(Text heading) { return {std::move(heading), TableColumn::Content::words}; }
TableColumn symbol(Text heading) { return {std::move(heading), TableColumn::Content::symbol}; }
TableColumn quantity(Text heading) { return {std::move(heading), TableColumn::Content::number}; }

Text number(double value, int digits = 4) { return plain(significant(value, digits)); }

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
  table.columns = {words(plain("parameter")),    symbol(plain("symbol")),
                   symbol(plain("Eq.")),         quantity(plain("ours ± standard error")),
                   quantity(plain("published")), quantity(plain("difference")),
                   words(plain("note"))};
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const ParameterInfo& info = parameter_table()[i];
    const fit::Estimate& estimate = calibration.estimates[i];
    const bool known = estimate.status != fit::Status::not_identified;
    const double published = info.published.value_or(kNone);
    table.rows.push_back({plain(info.name), paper_symbol(info.symbol), equation_text(info.equation),
                          plain(estimate_text(estimate)), number(published, 5),
                          plain(percent_difference(known ? estimate.value : kNone, published)), plain(estimate.note)});
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
      const double ours = known ? c.of(calibration.parameters, nu) : kNone;
      row.push_back(plain(known
                              ? significant_padded(ours, 4) + " (" + percent_difference(ours, c.of(published, nu)) + ")"
                              : "not identified"));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table stage_table(const fit::Calibration& calibration) {
  Table table;
  table.caption = "Stages of the fit";
  table.source = "calibration.json";
  table.columns = {words(plain("stage")),         quantity(plain("free")),          quantity(plain("residuals")),
                   quantity(plain("iterations")), quantity(plain("cost at start")), quantity(plain("cost at end")),
                   quantity(plain("seconds")),    words(plain("window")),           words(plain("termination"))};
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
  table.columns = {words(plain("test")),
                   words(plain("quantity")),
                   words(plain("fitted")),
                   quantity(plain("rows")),
                   quantity(plain("left out")),
                   quantity(plain("RMS")),
                   quantity(plain("bias")),
                   quantity(plain("RMS/max|DEM| [%]")),
                   quantity(plain("bias/max|DEM| [%]"))};
  for (const fit::Stage& stage : calibration.stages) {
    if (stage.name != "evolution") continue;
    for (const fit::TestResidual& r : stage.tests) {
      table.rows.push_back({plain(r.test), plain(r.quantity), plain(r.in_cost ? "yes" : "shown only"),
                            plain(std::to_string(r.rows)), plain(std::to_string(r.rows_excluded)), number(r.rms, 3),
                            number(r.bias, 3), plain(fixed(percent(r.rms, r.max_abs_data), 2)),
                            plain(fixed(percent(r.bias, r.max_abs_data), 2))});
    }
  }
  return table;
}

Table prediction_summary(const std::vector<PredictionFolder>& predictions) {
  Table table;
  table.caption = "Prediction minus DEM, mean over seeds: bias, and RMS over max|DEM|";
  table.source = "predictions/*/comparison.json";
  table.columns = {words(plain("path")),
                   words(plain("model")),
                   words(plain("start")),
                   quantity(notation("{P}* bias")),
                   quantity(notation("{P}* RMS [%]")),
                   quantity(notation("{s}_{∥} bias")),
                   quantity(notation("{s}_{∥} RMS [%]")),
                   quantity(notation("{F}_{∥} bias")),
                   quantity(notation("{F}_{∥} RMS [%]"))};
  for (const PredictionFolder& prediction : predictions) {
    for (const CurveComparison& entry : prediction.comparisons) {
      if (entry.seed) continue;
      std::vector<Text> row{plain(prediction.name), plain(predict::to_string(entry.model)),
                            plain(to_string(entry.initial))};
      for (const char* name : {"P_star", "s_par", "F_par"}) {
        const auto& all = entry.comparison.quantities;
        const auto found = std::find_if(all.begin(), all.end(), [&](const auto& q) { return q.quantity == name; });
        row.push_back(plain(found == all.end() ? kNoNumber : significant_padded(found->bias, 2)));
        row.push_back(plain(found == all.end() ? kNoNumber : fixed(100 * found->normalised_rms, 1)));
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

Table prediction_table(const PredictionFolder& prediction) {
  Table table;
  table.caption = prediction.name + ": prediction minus DEM, run by run";
  table.source = "predictions/" + prediction.name + "/comparison.json";
  table.columns = {words(plain("model")),       words(plain("start")),
                   quantity(plain("DEM seed")), words(plain("quantity")),
                   quantity(plain("rows")),     quantity(plain("bias")),
                   quantity(plain("RMS")),      quantity(plain("RMS/max|DEM| [%]")),
                   quantity(plain("largest")),  quantity(notation("at {ε}_{dev}")),
                   quantity(notation("at {ν}"))};
  for (const CurveComparison& entry : prediction.comparisons) {
    for (const predict::QuantityComparison& q : entry.comparison.quantities) {
      table.rows.push_back({plain(predict::to_string(entry.model)), plain(to_string(entry.initial)),
                            plain(entry.seed ? std::to_string(*entry.seed) : "mean"), plain(q.quantity),
                            plain(std::to_string(q.rows)), number(q.bias, 3), number(q.rms, 3),
                            plain(fixed(100 * q.normalised_rms, 2)), number(q.largest, 3),
                            number(q.largest_at_eps_dev, 3), plain(fixed(q.largest_at_nu, 3))});
    }
  }
  return table;
}

Table solver_table(const std::vector<PredictionFolder>& predictions) {
  Table table;
  table.caption = "What the integration of the law took";
  table.source = "predictions/*/prediction.json";
  table.columns = {words(plain("path")),
                   words(plain("model")),
                   words(plain("start")),
                   quantity(plain("DEM seed")),
                   quantity(plain("rows")),
                   quantity(plain("steps")),
                   quantity(plain("right-hand sides")),
                   quantity(plain("failed error tests")),
                   quantity(plain("restarts")),
                   quantity(plain("seconds"))};
  for (const PredictionFolder& prediction : predictions) {
    for (const PredictedCurve& drawn : prediction.curves) {
      const predict::SolverStatistics& s = drawn.prediction.statistics;
      table.rows.push_back({plain(prediction.name), plain(predict::to_string(drawn.model)),
                            plain(to_string(drawn.initial)),
                            plain(drawn.seed ? std::to_string(*drawn.seed) : kNoNumber),
                            plain(std::to_string(drawn.prediction.rows.size())), plain(std::to_string(s.steps)),
                            plain(std::to_string(s.rhs_evaluations)), plain(std::to_string(s.error_test_failures)),
                            plain(std::to_string(s.restarts)), number(s.seconds, 2)});
    }
  }
  return table;
}

Table run_table(const ReportInput& input) {
  Table table;
  table.caption = "Runs of the data set";
  table.source = "dataset/";
  table.columns = {words(plain("test")),
                   words(plain("role")),
                   words(plain("path")),
                   quantity(notation("{ν} at start")),
                   quantity(plain("seed")),
                   quantity(notation("{N}")),
                   quantity(plain("rows")),
                   quantity(plain("steps")),
                   quantity(plain("seconds")),
                   quantity(notation("median {E}_{kin}/{E}_{pot}")),
                   quantity(plain("largest |energy residual|")),
                   quantity(notation("largest {I}"))};
  for (std::size_t i = 0; i < input.tests.size(); ++i) {
    const TestRecord& test = input.tests[i];
    const RunCost& cost = input.costs[i];
    const bool known = cost.steps > 0;
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
         plain(std::to_string(test.rows.size())), plain(known ? std::to_string(cost.steps) : kNoNumber),
         plain(known ? significant(cost.seconds, 3) : kNoNumber), number(median, 2),
         number(largest(test, [](const Observation& row) { return std::abs(row.energy_residual); }), 2),
         number(largest(test, [](const Observation& row) { return row.inertial_number; }), 2)});
  }
  return table;
}

Table cost_table(const ReportInput& input) {
  Table table;
  table.caption = "What the DEM runs cost";
  table.columns = {words(plain("files")), quantity(plain("tests")), quantity(plain("time steps")),
                   quantity(plain("particle-steps")), quantity(plain("seconds, all runs together"))};
  const auto add = [&](const std::string& files, std::size_t count, const auto& test_of, const auto& cost_of) {
    double steps = 0, work = 0, seconds = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const RunCost& cost = cost_of(i);
      steps += static_cast<double>(cost.steps);
      work += static_cast<double>(cost.steps) * static_cast<double>(test_of(i).packing.particles);
      seconds += cost.seconds;
    }
    table.rows.push_back({plain(files), plain(std::to_string(count)), number(steps), number(work), number(seconds)});
  };
  add(
      "dataset/", input.tests.size(), [&](std::size_t i) -> const TestRecord& { return input.tests[i]; },
      [&](std::size_t i) -> const RunCost& { return input.costs[i]; });
  for (const PredictionFolder& prediction : input.predictions) {
    if (!prediction.dem) continue;
    const auto& tests = prediction.dem->tests;
    add(
        "predictions/" + prediction.name + "/dem/", tests.size(),
        [&](std::size_t i) -> const TestRecord& { return tests[i].record; },
        [&](std::size_t i) -> const RunCost& { return tests[i].cost; });
  }
  return table;
}

Table provenance_table(const ReportInput& input) {
  Table table;
  table.caption = "Where this comes from";
  table.columns = {words(plain("what")), words(plain("value")), words(plain("said by"))};
  for (const Fact& fact : input.provenance) {
    std::string files;
    for (const std::string& file : fact.files) files += (files.empty() ? "" : ", ") + file;
    table.rows.push_back({plain(fact.what), plain(fact.value), plain(files)});
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
