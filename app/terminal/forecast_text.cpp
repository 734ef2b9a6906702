#include "app/terminal/forecast_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/terminal/help.hpp"
#include "app/terminal/progress_printer.hpp"
#include "model/files/fields_json.hpp"

namespace grainlaw::app {
namespace {

std::string labelled(const char* what, const std::string& text) {
  std::string lines;
  for (const std::string& part : wrapped(text, 66)) lines += fmt::format("  {:<9} {}\n", std::exchange(what, ""), part);
  return lines;
}

std::string size_text(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.1f} MB", bytes / 1e6) : fmt::format("{:.1f} GB", bytes / 1e9);
}

}  // namespace

CLI::Option* add_dry_run(CLI::App& command, bool& dry_run) {
  return command.add_flag("--dry-run", dry_run,
                          "say what would be done, how long and how much disk it takes; do nothing");
}

std::string text_of(const chain::Forecast& forecast, int threads) {
  const dem::ExpectedCost& cost = forecast.cost;
  std::string text;
  if (cost.runs > 0) text += labelled("runs", fmt::format("{}, of which {} are finished", cost.runs, cost.found));
  if (std::isfinite(forecast.rate)) {
    std::string time = fmt::format("about {}", clock_text(forecast.run_seconds + forecast.fit_seconds));
    if (cost.runs > 0 && forecast.fit_seconds > 0)
      time += fmt::format(", of it the fit {}", clock_text(forecast.fit_seconds));
    if (cost.particle_steps > 0) text += labelled("work", fmt::format("{:.3g} particle-steps", cost.particle_steps));
    text += labelled("time", fmt::format("{} on {} thread{}, at {:.3g} million particle-steps/s in all, measured now",
                                         time, threads, threads == 1 ? "" : "s", forecast.rate / 1e6));
  }
  if (cost.bytes > 0) text += labelled("disk", "about " + size_text(cost.bytes));
  const PathTraits& covers = forecast.covers;
  if (covers.nu_max > 0)
    text += labelled("covers", fmt::format("volume fraction {:.4g} to {:.4g}, deviatoric strain to {:.4g}",
                                           covers.nu_min, covers.nu_max, covers.eps_dev));
  for (const std::string& note : forecast.notes) text += labelled("note", note);
  return text;
}

ExitCode say_forecast(const std::string& name, const chain::Forecast& forecast, const Session& session) {
  OrderedJson document{{"file", name}};
  document.update(fields_to_json(forecast));
  print_result(session.json ? json_text(document)
                            : fmt::format("{}: nothing was done\n{}", name, text_of(forecast, session.threads)));
  return ExitCode::ok;
}

}  // namespace grainlaw::app
