// What the fit found: shear parameters over density, and what the coupled fit leaves over.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "app/report/figures.hpp"
#include "app/report/series.hpp"
#include "model/evolution.hpp"

namespace grainlaw::app::report {
namespace {

using fit::ShearFit;
using Law = LawParameters<double>;

/// A quantity of Eq. (20).
struct ShearQuantity {
  const char* label;
  const char* curve;  ///< in density_curves()
  Estimate ShearFit::*staged;
  double ShearFit::*steady_mean;     ///< null for rates
  double LawModuli<double>::*limit;  ///< null for rates
};

constexpr std::array<ShearQuantity, 4> kShearQuantities{
    {{"steady stress ratio {s}_{max} [–]", "stress_ratio_max", &ShearFit::s_max, &ShearFit::s_steady,
      &LawModuli<double>::s_max},
     {"rate {β}_{s} [–]", "stress_rate", &ShearFit::beta_s, nullptr, nullptr},
     {"steady fabric {F}_{max} [–]", "fabric_max", &ShearFit::F_max, &ShearFit::F_steady, &LawModuli<double>::F_max},
     {"rate {β}_{F} [–]", "fabric_rate", &ShearFit::beta_F, nullptr, nullptr}}};

constexpr std::array<std::pair<const char*, const char*>, 3> kMisfits{
    {{"P_star", "pressure {P}*"}, {"s_par", "stress ratio {s}_{∥}"}, {"F_par", "fabric {F}_{∥}"}}};

/// The parameters before the coupled fit: the last value that a stage in front of it gave.
Law staged_parameters(const fit::Calibration& calibration) {
  Law staged = calibration.law.parameters;
  const auto to = fields(staged);
  for (const fit::Stage& stage : calibration.stages) {
    if (stage.name == "evolution") break;
    for (const fit::NamedEstimate& named : stage.estimates) {
      if (named.estimate.status != Status::not_identified) *to[parameter_index(named.name)] = named.estimate.value;
    }
  }
  return staged;
}

bool is_sheared_by(const fit::Calibration& calibration, Mode mode) {
  return std::ranges::any_of(calibration.shear, [=](const ShearFit& fit) { return fit.mode == mode; });
}

/// The runs of `mode`, each fitted by itself.
Series per_run_points(const fit::Calibration& calibration, Mode mode, const ShearQuantity& quantity) {
  const Series style =
      open_symbols(plain(to_string(mode) + ", DEM (fit per run)"), mode == Mode::D2 ? Colour::blue : Colour::green,
                   mode == Mode::D2 ? Marker::circle : Marker::diamond);
  const auto value = [&](const ShearFit& fit) {
    const Estimate& estimate = fit.*quantity.staged;
    return estimate.status == Status::not_identified ? std::numeric_limits<double>::quiet_NaN() : estimate.value;
  };
  const auto is_of_mode = [=](const ShearFit& fit) { return fit.mode == mode; };
  Series series = through(style, calibration.shear, &ShearFit::nu, value, is_of_mode);
  for (const ShearFit& fit : calibration.shear) {
    if (is_of_mode(fit)) series.y_error.push_back((fit.*quantity.staged).standard_error);
  }
  return series;
}

/// Densities of the shear fits; the calibrated range when they are one.
Range sheared_range(const fit::Calibration& calibration) {
  Range range{calibration.law.range.nu_max, calibration.law.range.nu_min};
  for (const ShearFit& shear : calibration.shear)
    range = {std::min(range.from, shear.nu), std::max(range.to, shear.nu)};
  return range.from < range.to ? range : Range{calibration.law.range.nu_min, calibration.law.range.nu_max};
}

Panel shear_panel(const fit::Calibration& calibration, const ShearQuantity& quantity) {
  const DensityCurve& law = density_curve(quantity.curve);
  const bool known = has_values(calibration.law, law);
  Panel panel = panel_of(known ? "" : "Eq. 20 not identified by these tests", kDensityLabel, quantity.label);
  panel.y.include = 0;
  for (const Mode mode : {Mode::D2, Mode::D3}) {
    if (is_sheared_by(calibration, mode)) panel.series.push_back(per_run_points(calibration, mode, quantity));
  }
  if (quantity.steady_mean != nullptr) {
    panel.series.push_back(through(symbols(plain("DEM, steady mean"), Colour::green, Marker::cross), calibration.shear,
                                   &ShearFit::nu, quantity.steady_mean));
  }
  const auto add = [&](const char* name, Colour colour, Line line, const auto& of_density) {
    const Range range = sheared_range(calibration);
    Series style = line_of(plain(name), colour, line);
    if (line == Line::dotted) style.toggle = "before the coupled fit";
    panel.series.push_back(curve(style, range.from, range.to, of_density));
  };
  const Law published = published_parameters(), staged = staged_parameters(calibration);
  const Law& coupled = calibration.law.parameters;
  add("published", Colour::ink, Line::dashed, [&](double nu) { return law.of(published, nu); });
  if (!known) return panel;
  add("Eq. 20, staged", Colour::blue, Line::dotted, [&](double nu) { return law.of(staged, nu); });
  add("Eq. 20, final", Colour::vermillion, Line::solid, [&](double nu) { return law.of(coupled, nu); });
  if (quantity.limit != nullptr && is_sheared_by(calibration, Mode::D3)) {
    const LawDirection D3 = law_direction(direction_of(Mode::D3, "xyz", false));
    add("final, D3", Colour::green, Line::solid,
        [&](double nu) { return along(moduli_at(coupled, nu), coupled.lode, D3).*quantity.limit; });
  }
  return panel;
}

}  // namespace

Figure shear_law_figure(const chain::ReportInput& input) {
  std::vector<Panel> panels;
  for (const ShearQuantity& quantity : kShearQuantities) panels.push_back(shear_panel(input.calibration, quantity));
  return {.id = "shear-laws",
          .title = "Steady values and rates of shear against volume fraction",
          .description =
              "Four panels over volume fraction, all falling: steady stress ratio, its rate, steady deviatoric fabric, "
              "its rate. Symbols are fits of single DEM runs, solid lines equation 20 after the coupled fit, dotted "
              "lines equation 20 before it, dashed lines the published law.",
          .caption = notation("Eq. 20 with {ν}_{c} fixed. Circles: Eqs. 17 and 18 fitted run by run; crosses: mean of "
                              "the steady rows. Dotted: staged fit of Eq. 20. Solid: after the coupled fit of Eq. 16, "
                              "of D2 and, where D3 was fitted, of D3 by its Lode angle. Dashed: Table 3 of the paper."),
          .sources = {"calibration.json", "parameters.json"},
          .panels = panels,
          .columns = 2,
          .panel_height = 200};
}

Figure residual_figure(const chain::ReportInput& input) {
  const std::vector<chain::Misfit> misfits = chain::coupled_misfits(input);
  std::vector<std::string> kinds;
  for (const TestRecord& test : input.tests) {
    const std::string kind = kind_of(test.path);
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
  }
  std::vector<Panel> panels;
  for (const auto of : {&fit::TestResidual::rms, &fit::TestResidual::bias}) {
    for (const auto& [quantity, title] : kMisfits) {
      Panel& panel =
          panels.emplace_back(panel_of(title, "volume fraction {ν} at the start [–]",
                                       of == &fit::TestResidual::rms ? "RMS/max|DEM| [%]" : "bias/max|DEM| [%]"));
      panel.y.include = 0;
      panel.zero_line = true;
      for (std::size_t k = 0; k < kinds.size(); ++k) {
        Series series = through(
            open_symbols(plain(kinds[k]), colour_of(k), marker_of(k)), misfits,
            [](const chain::Misfit& misfit) { return misfit.test.path.nu; },
            [&](const chain::Misfit& misfit) { return 100 * misfit.residual.*of / misfit.residual.max_abs_data; },
            [&, name = quantity](const chain::Misfit& misfit) {
              return misfit.residual.quantity == name && kind_of(misfit.test.path) == kinds[k];
            });
        if (!series.x.empty()) panel.series.push_back(std::move(series));
      }
    }
  }
  return {
      .id = "residuals",
      .title = "Misfit of the coupled fit, test by test",
      .description =
          "Two rows of three panels over the starting density of each calibration test: root mean square and mean of "
          "model minus DEM, divided by the largest DEM value, for pressure, stress ratio and fabric.",
      .caption = notation("Model (Eq. 16) minus DEM over max|DEM| of the test. In D2 the bias of {P}* grows towards "
                          "jamming: Eq. 16 has no dilatancy, so pressure hardly changes at constant volume while that "
                          "of the packing rises. This is the known gap of the law, shown and not fitted away."),
      .sources = {"calibration.json"},
      .panels = panels,
      .columns = 3,
      .panel_height = 170};
}

}  // namespace grainlaw::app::report
