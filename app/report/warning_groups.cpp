#include "app/report/warning_groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

namespace grainlaw::app::report {
namespace {

constexpr double kIsostaticContacts = 6;  // as in a running test
constexpr double kInertiaWarned = 1e-3;
constexpr std::size_t kNamedPlaces = 6;

/// Warnings that hold these words are of one cause.
struct Cause {
  std::string_view words;
  const char* cause;
  const char* consequence;
};
constexpr std::array kCauses{
    Cause{"energy residual above", "energy balance of a run off by more than 0.1 % of its work",
          "The time step's error, taken as that of the stresses in these rows. Half the time_step_fraction makes it a "
          "quarter, at twice the cost; beyond 1 % a run stops."},
    Cause{"minimisations stopped short", "states not quite at rest",
          "Rows there are a little out of equilibrium; a larger relax.max_passes brings them nearer."},
    Cause{"not at rest", "probes of moduli not at rest", "Their moduli carry what the packing still moves."},
    Cause{"no positive stiffness", "probes without moduli", "The packing is not stable there, nothing is drawn."},
    Cause{"stand out from their neighbours", "rows that stand out",
          "They pull the fit; look at them, or repeat the test."},
    Cause{"packings of", "small packings",
          "What the size biases, jamming densities first, is in no interval; larger packings alone show it."},
    Cause{"the prior of the errors", "prior of the errors not used",
          "Intervals are by these packings alone, wider or narrower than usual by chance."},
    Cause{"outside rehearsals", "paths beyond the rehearsed ones",
          "Bands there are those of the rehearsed paths; how far the law is off beyond them is not known."},
    Cause{"spins", "paths with spin", "Nothing calibrated or rehearsed spins; how far the law is off is not known."},
    Cause{"without fabric", "no fabric in the data", "Fabric is not predicted, nor by the rungs that need it."},
    Cause{"packings that were fitted", "runs on packings that were fitted",
          "The law looks better along these than on new packings."},
    Cause{"the calibrated", "paths beyond the calibrated range",
          "The law is extrapolated there; no data hold it, and its bands do not know it."},
    Cause{"initial.branch", "a start on another branch", "The law's start is that of the unloading branch."},
    Cause{"is left out", "curves that are left out", "They are missing in figures and tables."},
    Cause{"bands are those of before", "predictions older than the rehearsals",
          "Their bands lack what was rehearsed since; predict again."},
    Cause{"digests differ", "another data set than the fitted one",
          "Law and data of this page do not belong together; calibrate again."},
    Cause{"other parameters", "predictions of other parameters", "They do not belong to this law; predict again."}};

/// The number behind "up to"; 0 without.
double largest_in(const std::string& text) {
  const std::size_t at = text.find("up to ");
  return at == std::string::npos ? 0 : std::strtod(text.c_str() + at + 6, nullptr);
}

void add_warning(const std::string& where, const std::string& text, std::vector<WarningGroup>& groups) {
  const auto known = std::find_if(kCauses.begin(), kCauses.end(),
                                  [&](const Cause& c) { return text.find(c.words) != std::string::npos; });
  const std::string cause = known == kCauses.end() ? text : known->cause;
  auto group = std::find_if(groups.begin(), groups.end(), [&](const WarningGroup& g) { return g.cause == cause; });
  if (group == groups.end())
    group = groups.insert(groups.end(), {cause, known == kCauses.end() ? "" : known->consequence, text});
  else if (largest_in(text) > largest_in(group->example))
    group->example = text;
  if (std::find(group->where.begin(), group->where.end(), where) == group->where.end()) group->where.push_back(where);
}

/// The jammed rows that move too fast, of one run.
void add_inertia(const TestRecord& test, std::vector<WarningGroup>& groups) {
  std::size_t rows = 0;
  double worst = 0, nu = 0;
  for (const Observation& row : test.rows) {
    if (!(row.C_star >= kIsostaticContacts && row.inertial_number > kInertiaWarned)) continue;
    ++rows;
    if (row.inertial_number > worst) worst = row.inertial_number, nu = row.nu;
  }
  if (rows == 0) return;
  const std::string cause = "jammed rows with an inertial number above 0.001";
  auto group = std::find_if(groups.begin(), groups.end(), [&](const WarningGroup& g) { return g.cause == cause; });
  if (group == groups.end())
    group = groups.insert(
        groups.end(),
        {cause, "Inertia adds to the stress there; half the strain_rate halves the inertial number, at twice the cost.",
         fmt::format("{} of {} rows, up to {:.2g} at nu = {:.4f}", rows, test.rows.size(), worst, nu)});
  group->where.push_back(test.name);
}

}  // namespace

std::vector<WarningGroup> warning_groups(const chain::ReportInput& input) {
  std::vector<WarningGroup> groups;
  for (const std::string& warning : input.warnings) add_warning("files", warning, groups);
  for (const std::string& warning : input.calibration.warnings) add_warning("fit", warning, groups);
  for (const predict::PredictionFolder& prediction : input.predictions) {
    for (const std::string& warning : prediction.warnings) add_warning(prediction.name, warning, groups);
    for (const predict::FailedCurve& failed : prediction.failures)
      add_warning(prediction.name, fmt::format("{} is left out: {}", to_string(failed.model), failed.error), groups);
    for (const predict::PredictedCurve& drawn : prediction.curves) {
      for (const std::string& warning : drawn.prediction.warnings) add_warning(prediction.name, warning, groups);
    }
    for (const TestRecord& test : chain::dem_records(prediction)) add_inertia(test, groups);
  }
  for (const TestRecord& test : input.tests) add_inertia(test, groups);
  for (const std::string& warning : input.run_warnings) {
    const std::size_t colon = warning.find(": ");
    if (warning.find("inertial number") != std::string::npos || colon == std::string::npos) continue;
    add_warning(warning.substr(0, colon), warning.substr(colon + 2), groups);
  }
  return groups;
}

Table warning_table(const std::vector<WarningGroup>& groups) {
  Table table = table_of("Warnings by cause, each counted once", "", groups,
                         {{"cause", Content::words, &WarningGroup::cause},
                          {"where", Content::number, [](const WarningGroup& g) { return g.where.size(); }},
                          {"what it costs", Content::words, &WarningGroup::consequence}});
  for (const WarningGroup& group : groups) {
    const std::size_t named = std::min(group.where.size(), kNamedPlaces);
    table.notes.push_back(fmt::format(
        "{}{}; e.g. {}", fmt::join(group.where.begin(), group.where.begin() + static_cast<std::ptrdiff_t>(named), ", "),
        named < group.where.size() ? " …" : "", group.example));
  }
  return table;
}

}  // namespace grainlaw::app::report
