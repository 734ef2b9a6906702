#include "app/terminal/study_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/files/one_line.hpp"

namespace grainlaw::app {
namespace {

constexpr std::size_t kNote = 120;  // characters; study.json has them all

std::string percent(double share) { return std::isfinite(share) ? fmt::format("{:.2f}%", 100 * share) : "-"; }

std::string line_of(const chain::SettingResult& r, chain::Packings packings, std::size_t width) {
  const chain::SettingOutcome& o = r.outcome;
  const auto error = [packings](double x) {
    return packings == chain::Packings::chosen || !std::isfinite(x) ? percent(x) : fmt::format("{:.2f}", x);
  };
  std::string text = fmt::format("{:<{}} {:>8} {:>14.3e} {:>9.1f} {:>7.1f} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}", o.name,
                                 width, o.seeds.size(), o.cost.particle_steps, o.cost.seconds, o.cost.fit_seconds,
                                 error(r.error), error(r.floor), error(r.sampling), error(r.reached),
                                 error(r.reached_error), percent(o.energy_residual));
  if (chain::near_the_stop(o.energy_residual)) text += "  near the energy balance's stop";
  if (!r.dominated_by.empty()) text += "  dominated";
  if (!o.model.empty()) text += "  " + o.model;
  if (!o.note.empty()) text += "  " + one_line(o.note, kNote);
  return text + "\n";
}

std::string verdict_of(const chain::SettingResult& judged) {
  if (!std::isfinite(judged.reached)) return fmt::format("{} shows nothing to be judged by\n", judged.outcome.name);
  const std::string by = fmt::format("{}", fmt::join(judged.dominated_by, ", ")),
                    perhaps = fmt::format("{}", fmt::join(judged.perhaps_dominated_by, ", "));
  std::string text = judged.outcome.name;
  if (!by.empty())
    text += " is dominated by " + by + (perhaps.empty() ? "" : "; perhaps by " + perhaps);
  else if (!perhaps.empty())
    text += " may be dominated: cheaper and as good or better, within chance: " + perhaps;
  else
    text += " is not dominated";
  text += "\n";
  return text;
}

}  // namespace

std::string study_text(const chain::SettingsStudy& study) {
  std::size_t width = 7;
  for (const chain::SettingResult& r : study.results) width = std::max(width, r.outcome.name.size());
  std::string text =
      fmt::format("{:<{}} {:>8} {:>14} {:>9} {:>7} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "setting", width, "packings",
                  "particle-steps", "seconds", "of fit", "error", "floor", "sampling", "reached", "+-", "energy");
  for (const chain::SettingResult& r : study.results) text += line_of(r, study.packings, width);
  if (study.packings == chain::Packings::given) text += "errors in units of the packings' chance\n";
  return text + verdict_of(study.results.at(study.judged));
}

std::string study_text(const predict::IntegratorStudy& study) {
  std::string text =
      fmt::format("least microseconds of a path with an error of at most {:.0e}\n", predict::kWantedError);
  for (const predict::WorkPrecision& panel : study.panels) {
    text += fmt::format("{}: {}\n", panel.path.name, panel.path.description);
    for (const predict::Integrator& integrator : predict::kIntegrators) {
      const predict::WorkPoint* point = predict::quickest(panel, predict::kWantedError, &integrator);
      text += point ? fmt::format("  {:<7} {:8.1f} us  {:6} right-hand sides  error {:.1e}  (accuracy {:.1e})\n",
                                  to_string(integrator), point->microseconds, point->rhs_evaluations, point->error,
                                  point->accuracy)
                    : fmt::format("  {:<7} not reached\n", to_string(integrator));
    }
  }
  for (const predict::BatchTime& time : study.batch) {
    text += fmt::format("batch: {} paths on {} threads by {} at {:.0e}: {:.2f} s\n", study.paths, study.threads,
                        to_string(time.integrator), time.accuracy, time.seconds);
  }
  return text;
}

std::string study_text(const chain::BandsStudy& study) {
  std::size_t width = 4;
  for (const chain::BandCoverage& c : study.coverages) width = std::max(width, c.path.size());
  std::string text =
      fmt::format("{:<9} {:<9} {:<{}} {:>2} {:<7} {:>5} {:>3} {:>9} {:>9} {:>9} {:>8} {:>5} {:>7}\n", "model", "kind",
                  "path", width, "n", "", "rows", "m", "bias/w", "rms/w", "tau/w", "without", "mean", "single");
  for (const chain::BandCoverage& c : study.coverages) {
    text += fmt::format(
        "{:<9} {:<9} {:<{}} {:>2} {:<7} {:>5} {:>3}{} {:>+8.5f} {:>9.5f} {:>9.5f} {:>7.0f}% {:>4.0f}% {:>6.0f}%\n",
        to_string(c.model), to_string(c.kind), c.path, width, c.packings, to_string(c.quantity), c.rows,
        c.degrees_of_freedom, c.of_kind ? " " : "*", c.bias, c.rms, c.tau, 100 * c.without, 100 * c.mean,
        100 * c.single);
  }
  text += "* too few others of the kind: all\nover the paths, each left out (least of a path)\n";
  for (const chain::CoverageSummary& s : study.summaries) {
    text += fmt::format(
        "{:<9} {:<7} {:>3} paths  without {:3.0f}%  mean {:5.1f}% ({:.0f})  single run {:5.1f}% ({:.0f})  whole "
        "curves {:.0f}% of {:.0f}\n",
        to_string(s.model), to_string(s.quantity), s.paths, 100 * s.without, 100 * s.mean, 100 * s.least_mean,
        100 * s.single, 100 * s.least_single, 100 * s.whole, 100 * s.promised_whole);
  }
  return text;
}

}  // namespace grainlaw::app
