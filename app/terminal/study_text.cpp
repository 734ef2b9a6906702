#include "app/terminal/study_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/terminal/help.hpp"
#include "model/files/one_line.hpp"

namespace grainlaw::app {
namespace {

constexpr std::size_t kNote = 200;  // characters; study.json has them all

std::string percent(double share) { return std::isfinite(share) ? fmt::format("{:.2f}%", 100 * share) : "-"; }

/// The name with what is said of it, the numbers below.
std::string lines_of(const chain::SettingResult& r, chain::Packings packings) {
  const chain::SettingOutcome& o = r.outcome;
  const auto error = [packings](double x) {
    return packings == chain::Packings::chosen || !std::isfinite(x) ? percent(x) : fmt::format("{:.2f}", x);
  };
  std::string name = o.name;
  if (chain::near_the_stop(o.energy_residual)) name += "  near the energy balance's stop";
  if (!r.dominated_by.empty()) name += "  dominated";
  if (!o.model.empty()) name += "  " + o.model;
  if (!o.note.empty()) name += "  " + one_line(o.note, kNote);
  return fmt::format("{}\n{:>5} {:>9.2e} {:>8.1f} {:>6.1f} {:>7} {:>7} {:>8} {:>8} {:>7} {:>6}\n",
                     fmt::join(wrapped(name, 80), "\n  "), o.seeds.size(), o.cost.particle_steps, o.cost.seconds,
                     o.cost.fit_seconds, error(r.error), error(r.floor), error(r.sampling), error(r.reached),
                     error(r.reached_error), percent(o.energy_residual));
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
  return fmt::format("{}\n", fmt::join(wrapped(text, 80), "\n"));
}

}  // namespace

std::string study_text(const chain::SettingsStudy& study) {
  std::string text = fmt::format("{:>5} {:>9} {:>8} {:>6} {:>7} {:>7} {:>8} {:>8} {:>7} {:>6}\n", "seeds", "work",
                                 "seconds", "of fit", "error", "floor", "sampling", "reached", "+-", "energy");
  for (const chain::SettingResult& r : study.results) text += lines_of(r, study.packings);
  text += "work in particle-steps\n";
  if (study.packings == chain::Packings::given) text += "errors in units of the packings' chance\n";
  return text + verdict_of(study.results.at(study.judged));
}

std::string study_text(const predict::IntegratorStudy& study) {
  std::string text =
      fmt::format("least microseconds of a path with an error of at most {:.0e}\n", predict::kWantedError);
  for (const predict::WorkPrecision& panel : study.panels) {
    text += fmt::format("{}\n", fmt::join(wrapped(panel.path.name + ": " + panel.path.description, 78), "\n  "));
    for (const predict::Integrator& integrator : predict::kIntegrators) {
      const predict::WorkPoint* point = predict::quickest(panel, predict::kWantedError, &integrator);
      text += point ? fmt::format("  {:<7} {:8.1f} us {:6} right-hand sides, error {:.1e} (accuracy {:.1e})\n",
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
  constexpr const char* kRow = "  {:<7} {:>5} {:>4} {:>16} {:>7} {:>7} {:>8} {:>5} {:>7}\n";
  std::string text =
      fmt::format(fmt::runtime(kRow), "", "rows", "m", "bias/w", "rms/w", "tau/w", "without", "mean", "single");
  std::string heading;
  for (const chain::BandCoverage& c : study.coverages) {
    std::string above = fmt::format("{}: {}, {}, n = {}\n", c.path, to_string(c.model), to_string(c.kind), c.packings);
    if (above != heading) text += heading = std::move(above);
    const auto share = [](double x) { return fmt::format("{:.0f}%", 100 * x); };
    text += fmt::format(fmt::runtime(kRow), to_string(c.quantity), c.rows,
                        fmt::format("{}{}", c.degrees_of_freedom, c.of_kind ? "" : "*"),
                        fmt::format("{:+.4f} ± {:.4f}", c.bias, c.bias_error), fmt::format("{:.4f}", c.rms),
                        fmt::format("{:.4f}", c.tau), share(c.without), share(c.mean), share(c.single));
  }
  constexpr const char* kSum = "{:<9} {:<8} {:>5} {:>8} {:>6} {:>6} {:>7} {:>6} {:>7} {:>9}\n";
  text += "* too few others of the kind: all\n\nover the paths, each left out; least: of a path\n";
  text += fmt::format(fmt::runtime(kSum), "model", "quantity", "paths", "without", "mean", "least", "single", "least",
                      "curves", "promised");
  for (const chain::CoverageSummary& s : study.summaries) {
    const auto share = [](double x) { return fmt::format("{:.0f}%", 100 * x); };
    text += fmt::format(fmt::runtime(kSum), to_string(s.model), to_string(s.quantity), s.paths, share(s.without),
                        share(s.mean), share(s.least_mean), share(s.single), share(s.least_single), share(s.whole),
                        share(s.promised_whole));
  }
  return text;
}

}  // namespace grainlaw::app
