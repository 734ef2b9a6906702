#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "app/report/dem_series.hpp"
#include "app/report/figures.hpp"
#include "app/report/law_curves.hpp"
#include "model/evolution.hpp"

namespace grainlaw::app::report {
namespace {

struct Quantity20 {
  const char* label;
  const char* group;  ///< of its parameters
  Estimate fit::ShearFit::*staged;
  double fit::ShearFit::*steady_mean;  ///< null for rates
  ExponentialLaw<double> LawParameters<double>::*law;
  double LawModuli<double>::*limit;  ///< null for rates
};

/// The parameters before the coupled fit: the last value that a stage in front of it gave.
LawParameters<double> staged_parameters(const fit::Calibration& calibration) {
  LawParameters<double> staged = calibration.law.parameters;
  const auto to = fields(staged);
  for (const fit::Stage& stage : calibration.stages) {
    if (stage.name == "evolution") break;
    for (const fit::NamedEstimate& named : stage.estimates) {
      if (named.estimate.status != Status::not_identified) *to[parameter_index(named.name)] = named.estimate.value;
    }
  }
  return staged;
}

Series per_run_points(const ReportInput& input, Mode mode, const Quantity20& quantity) {
  Series series;
  series.label = plain(to_string(mode) + ", DEM (fit per run)");
  series.colour = mode == Mode::D2 ? Colour::blue : Colour::green;
  series.marker = mode == Mode::D2 ? Marker::circle : Marker::diamond;
  series.open_marker = true;
  for (const fit::ShearFit& shear : input.calibration.shear) {
    if (shear.mode != mode) continue;
    const Estimate& estimate = shear.*quantity.staged;
    const bool known = estimate.status != Status::not_identified;
    series.x.push_back(shear.nu);
    series.y.push_back(known ? estimate.value : std::numeric_limits<double>::quiet_NaN());
    series.y_error.push_back(estimate.standard_error);
  }
  return series;
}

Series steady_means(const ReportInput& input, const Quantity20& quantity) {
  Series series;
  series.label = plain("DEM, steady mean");
  series.colour = Colour::green;
  series.marker = Marker::cross;
  for (const fit::ShearFit& shear : input.calibration.shear) {
    series.x.push_back(shear.nu);
    series.y.push_back(shear.*quantity.steady_mean);
  }
  return series;
}

}  // namespace

Figure shear_law_figure(const ReportInput& input) {
  using P = LawParameters<double>;
  static const std::array<Quantity20, 4> quantities{
      {{"steady stress ratio {s}_{max} [–]", "stress_ratio_max", &fit::ShearFit::s_max, &fit::ShearFit::s_steady,
        &P::stress_ratio_max, &LawModuli<double>::s_max},
       {"rate {β}_{s} [–]", "stress_rate", &fit::ShearFit::beta_s, nullptr, &P::stress_rate, nullptr},
       {"steady fabric {F}_{max} [–]", "fabric_max", &fit::ShearFit::F_max, &fit::ShearFit::F_steady, &P::fabric_max,
        &LawModuli<double>::F_max},
       {"rate {β}_{F} [–]", "fabric_rate", &fit::ShearFit::beta_F, nullptr, &P::fabric_rate, nullptr}}};
  Figure figure;
  figure.id = "shear-laws";
  figure.title = "Steady values and rates of shear against volume fraction";
  figure.description =
      "Four panels over volume fraction, all falling: steady stress ratio, its rate, steady deviatoric fabric, its "
      "rate. Symbols are fits of single DEM runs, solid lines equation 20 after the coupled fit, dotted lines "
      "equation 20 before it, dashed lines the published law.";
  figure.caption = notation(
      "Eq. 20 with {ν}_{c} fixed. Circles: Eqs. 17 and 18 fitted run by run; crosses: mean of the "
      "steady rows. Dotted: staged fit of Eq. 20. Solid: after the coupled fit of Eq. 16, of D2 and, where D3 was "
      "fitted, of D3 by its Lode angle. Dashed: Table 3 of the "
      "paper.");
  figure.sources = {"calibration.json", "parameters.json"};
  figure.columns = 2;
  figure.panel_height = 200;

  const auto& calibration = input.calibration;
  const P published = published_parameters(), staged = staged_parameters(calibration);
  double from = calibration.law.range.nu_max, to = calibration.law.range.nu_min;
  for (const fit::ShearFit& shear : calibration.shear) {
    from = std::min(from, shear.nu);
    to = std::max(to, shear.nu);
  }
  if (!(from < to)) {
    from = calibration.law.range.nu_min;
    to = calibration.law.range.nu_max;
  }
  const LawDirection D3 = law_direction(direction_of(Mode::D3, "xyz", false));
  const bool sheared_by_D3 = std::any_of(calibration.shear.begin(), calibration.shear.end(),
                                         [](const fit::ShearFit& fit) { return fit.mode == Mode::D3; });
  for (const Quantity20& quantity : quantities) {
    Panel panel;
    panel.x.label = notation("volume fraction {ν} [–]");
    panel.y.label = notation(quantity.label);
    panel.y.include = 0;
    for (const Mode mode : {Mode::D2, Mode::D3}) {
      Series points = per_run_points(input, mode, quantity);
      if (!points.x.empty()) panel.series.push_back(std::move(points));
    }
    if (quantity.steady_mean != nullptr) panel.series.push_back(steady_means(input, quantity));
    const auto add = [&](const char* label, const P& parameters, Colour colour, Line line) {
      const ExponentialLaw<double>& law = parameters.*quantity.law;
      panel.series.push_back(
          curve(plain(label), colour, line, from, to, [&](double nu) { return law.value(nu, parameters.shear_nu_c); }));
    };
    add("published", published, Colour::ink, Line::dashed);
    if (!has_values(calibration.law, quantity.group)) {
      panel.title = plain("Eq. 20 not identified by these tests");
      figure.panels.push_back(panel);
      continue;
    }
    add("Eq. 20, staged", staged, Colour::blue, Line::dotted);
    add("Eq. 20, final", calibration.law.parameters, Colour::vermillion, Line::solid);
    if (quantity.limit != nullptr && sheared_by_D3) {
      const P& p = calibration.law.parameters;
      panel.series.push_back(curve(plain("final, D3"), Colour::green, Line::solid, from, to,
                                   [&](double nu) { return along(moduli_at(p, nu), p.lode, D3).*quantity.limit; }));
    }
    figure.panels.push_back(panel);
  }
  return figure;
}

}  // namespace grainlaw::app::report
