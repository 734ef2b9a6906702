#include <algorithm>
#include <array>
#include <string>

#include "app/report/series.hpp"
#include "app/report/figures.hpp"

namespace grainlaw::app::report {
namespace {

constexpr std::array<std::pair<const char*, const char*>, 3> kQuantities{
    {{"P_star", "pressure {P}*"}, {"s_par", "stress ratio {s}_{∥}"}, {"F_par", "fabric {F}_{∥}"}}};

const TestRecord* test_named(const ReportInput& input, const std::string& name) {
  const auto found =
      std::find_if(input.tests.begin(), input.tests.end(), [&](const TestRecord& test) { return test.name == name; });
  return found == input.tests.end() ? nullptr : &*found;
}

}  // namespace

Figure residual_figure(const ReportInput& input) {
  Figure figure;
  figure.id = "residuals";
  figure.title = "Misfit of the coupled fit, test by test";
  figure.description =
      "Two rows of three panels over the starting density of each calibration test: root mean square and mean of "
      "model minus DEM, divided by the largest DEM value, for pressure, stress ratio and fabric.";
  figure.caption = notation(
      "Model (Eq. 16) minus DEM over max|DEM| of the test. In D2 the bias of {P}* grows towards jamming: Eq. 16 has "
      "no dilatancy, so pressure hardly changes at constant volume while that of the packing rises. This is the "
      "known gap of the law, shown and not fitted away.");
  figure.sources = {"calibration.json"};
  figure.columns = 3;
  figure.panel_height = 170;

  const auto& stages = input.calibration.stages;
  const auto stage =
      std::find_if(stages.begin(), stages.end(), [](const fit::Stage& s) { return s.name == "evolution"; });
  std::vector<std::string> kinds;
  for (const TestRecord& test : input.tests) {
    const std::string kind = kind_of(test.path);
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
  }
  for (const bool bias : {false, true}) {
    for (const auto& [quantity, symbol] : kQuantities) {
      Panel panel;
      panel.title = notation(symbol);
      panel.x.label = notation("volume fraction {ν} at the start [–]");
      panel.y.label = plain(bias ? "bias/max|DEM| [%]" : "RMS/max|DEM| [%]");
      panel.y.include = 0;
      panel.zero_line = true;
      for (std::size_t k = 0; k < kinds.size() && stage != stages.end(); ++k) {
        Series series;
        series.label = plain(kinds[k]);
        series.colour = colour_of(k);
        series.marker = marker_of(k);
        series.open_marker = true;
        for (const fit::TestResidual& residual : stage->tests) {
          const TestRecord* test = test_named(input, residual.test);
          if (residual.quantity != quantity || test == nullptr || kind_of(test->path) != kinds[k]) continue;
          series.x.push_back(test->path.nu);
          series.y.push_back(100 * (bias ? residual.bias : residual.rms) / residual.max_abs_data);
        }
        if (!series.x.empty()) panel.series.push_back(std::move(series));
      }
      figure.panels.push_back(panel);
    }
  }
  return figure;
}

}  // namespace grainlaw::app::report
