#include "app/report/first_screen.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>

#include "app/report/series.hpp"
#include "app/report/tables.hpp"
#include "fit/leave_one_out.hpp"

namespace grainlaw::app::report {
namespace {

using chain::ErrorOverPaths, chain::PathError, chain::ReportInput;

constexpr std::array<double, kHeats - 1> kShades{0.025, 0.05, kGood, kRough};
constexpr std::array<const char*, 3> kSymbols{"{P}*", "{s}", "{F}"};
constexpr std::array<const char*, 3> kNames{"pressure", "stress ratio", "fabric"};
/// The kinds in words, in their order.
constexpr std::array<const char*, 4> kWhere{"shear one way, no expansion", "the volume grows", "the shear turns",
                                            "the shear turns back twice or more"};
constexpr double kLeastShare = 0.9;      // of rows in a 95 % band, below which it is said
constexpr int kManyPackings = 10;        // from which on their number is no reservation
constexpr double kJackknifeIsLarge = 2;  // over the stated error

std::string percent(double share) {
  const double p = 100 * share;
  return fmt::format("{:.{}f}", p, p < 10 ? 1 : 0);
}

/// "1.4 % (0.4–3.0)".
std::string error_text(const ErrorOverPaths& error) {
  if (error.paths == 0) return kNoNumber;
  if (error.paths == 1) return percent(error.rms) + " %";
  return fmt::format("{} % ({}–{})", percent(error.rms), percent(error.least), percent(error.largest));
}

ErrorOverPaths recommended_over(const std::vector<PathError>& errors, Rehearsed quantity, const auto& keep) {
  return error_over(errors, quantity, [&](const PathError& entry) { return entry.recommended && keep(entry); });
}

bool any(const PathError&) { return true; }
bool is_recommended(const PathError& entry) { return entry.recommended; }
bool is_predicted(const PathError& entry) { return entry.prediction != nullptr; }

std::size_t paths_of(const std::vector<PathError>& errors, const auto& keep) {
  std::set<std::string> names;
  for (const PathError& entry : errors) {
    if (keep(entry)) names.insert(entry.path + (is_predicted(entry) ? "/" : ""));
  }
  return names.size();
}

constexpr std::array<const char*, 3> kGrades{"good", "rough", "poor"};

/// Place in kGrades of a quantity on the paths of a kind: by all of them, or by the predicted ones where these do worse; nothing without any.
std::optional<std::size_t> grade_of(const std::vector<PathError>& errors, Rehearsed quantity, PathKind kind) {
  const auto all = recommended_over(errors, quantity, [=](const PathError& e) { return e.kind == kind; });
  const auto predicted =
      recommended_over(errors, quantity, [=](const PathError& e) { return e.kind == kind && is_predicted(e); });
  if (all.paths == 0) return std::nullopt;
  const double error = std::max(all.rms, predicted.rms);
  return error <= kGood ? 0 : error <= kRough ? 1 : 2;
}

std::string list_of(const std::vector<std::string>& words) {
  if (words.size() < 2) return words.empty() ? "" : words.front();
  return fmt::format("{} and {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

/// "frictionless", or what else their contacts know.
std::string kind_of_spheres(const ReportInput& input) {
  const ContactModel contacts = input.tests.empty() ? ContactModel{} : input.tests.front().packing.contacts;
  std::string kind = contacts.cohesion > 0 ? "cohesive " : "";
  if (contacts.normal_force == NormalForce::hertz) kind += "Hertzian ";
  if (contacts.friction == 0) return kind + "frictionless spheres";
  kind += fmt::format("spheres of friction {:g}", contacts.friction);
  return contacts.rolling_friction > 0 ? kind + fmt::format(" and rolling friction {:g}", contacts.rolling_friction)
                                       : kind;
}

Paragraph subject(const ReportInput& input) {
  std::set<std::int64_t> particles;
  std::size_t fitted = 0;
  for (const TestRecord& test : input.tests) {
    particles.insert(test.packing.particles);
    fitted += test.role == Role::calibration ? 1 : 0;
  }
  const ValidRange& range = input.calibration.law.range;
  const double width = input.tests.empty() ? 0 : input.tests.front().packing.size_width;
  const std::string sizes = width > 0 ? fmt::format(" (largest over smallest radius {:g})", width) : "";
  const std::size_t packings = seeds_of(input.tests).size();
  std::string command = fact_of(input, "command", "dataset/dataset.json");
  if (command.empty()) command = fact_of(input, "command", "parameters.json");
  return {notation(fmt::format("Calibrated from grains: {} {} of {} {}{}, {} tests fitted, {{ν}} = {:.3g} to "
                               "{:.3g}, deviatoric strain up to {:.3g}",
                               packings, packings == 1 ? "packing" : "packings", fmt::join(particles, " or "),
                               kind_of_spheres(input), sizes, fitted, range.nu_min, range.nu_max, range.eps_dev_max)) +
          plain(command.empty() ? "." : ", by " + command + ".")};
}

/// What the runs and the fit took.
Tile cost_tile(const ReportInput& input) {
  double seconds = 0, steps = 0;
  for (std::size_t i = 0; i < input.costs.size(); ++i) {
    seconds += input.costs[i].seconds;
    steps += static_cast<double>(input.costs[i].steps) * static_cast<double>(input.tests[i].packing.particles);
  }
  const std::string fit = fact_of(input, "seconds", "parameters.json");
  const std::string last =
      fit.empty() ? "" : "; the last calibrate took " + duration(std::strtod(fit.c_str(), nullptr));
  if (!(seconds > 0)) return {plain("cost"), plain(kNoNumber), "of DEM: the data do not tell it" + last};
  return {plain("cost"), plain(duration(seconds)),
          fmt::format("of DEM on one thread, {} billion particle-steps of element tests{}", significant(steps / 1e9, 3),
                      last),
          seconds};
}

Tiles error_tiles(const ReportInput& input, const std::vector<PathError>& errors) {
  const bool predicted = std::any_of(errors.begin(), errors.end(), is_predicted);
  const std::size_t shown = predicted ? paths_of(errors, is_predicted) : paths_of(errors, any),
                    all = paths_of(errors, any);
  Tiles tiles{
      fmt::format("Error on {} {} {} that the fit never saw: root mean square over the largest value, recommended rung",
                  shown, predicted ? "predicted" : "rehearsed", shown == 1 ? "path" : "paths"),
      {}};
  for (const Rehearsed quantity : kValues<Rehearsed>) {
    const auto i = static_cast<std::size_t>(quantity);
    const ErrorOverPaths over =
        predicted ? recommended_over(errors, quantity, is_predicted) : recommended_over(errors, quantity, any);
    std::string note = over.paths > 1 ? fmt::format("{} to {} %", percent(over.least), percent(over.largest)) : "";
    if (over.paths > 0 && static_cast<std::size_t>(over.paths) < shown)
      note += fmt::format("{}of {} of them", note.empty() ? "" : ", ", over.paths);
    if (predicted && all > shown)
      note += fmt::format("{}all {} paths: {}", note.empty() ? "" : "; ", all,
                          error_text(recommended_over(errors, quantity, any)));
    tiles.tiles.push_back({plain(std::string(kNames[i]) + " ") + notation(kSymbols[i]),
                           plain(over.paths > 0 ? percent(over.rms) + " %" : kNoNumber), note,
                           over.paths > 0 ? 100 * over.rms : kUndefined});
  }
  tiles.tiles.push_back(cost_tile(input));
  return tiles;
}

void doubt_fit(const ReportInput& input, std::vector<Reservation>& all) {
  const fit::Calibration& calibration = input.calibration;
  if (!calibration.law.converged) {
    std::vector<std::string> stages;
    for (const fit::Stage& stage : calibration.stages) {
      if (!stage.converged) stages.push_back(stage.name);
    }
    all.push_back(
        {100,
         fmt::format("Not converged: {}. Values and errors of these stages are not the optimum's.", list_of(stages)),
         "misfit"});
  }
  if (!input.warnings.empty())
    all.push_back(
        {95,
         input.warnings.front() +
             (input.warnings.size() > 1 ? fmt::format(" And {} more of this kind.", input.warnings.size() - 1) : ""),
         "warnings"});
  const auto packings = static_cast<int>(seeds_of(input.tests).size());
  if (packings < kManyPackings)
    all.push_back(
        {packings < 3   ? 85.0
         : packings < 5 ? 50.0
                        : 28.0,
         packings < 2
             ? std::string(
                   "1 packing: what chance does shows between packings alone, so that no number has an interval.")
             : fmt::format(
                   "{} packings: every interval is Student's with that few, and chance that they share is in no "
                   "interval.",
                   packings),
         "parameters"});
  for (const std::string& warning : calibration.warnings) {
    const bool size = warning.starts_with("packings of"), mixed = warning.find("digests differ") != std::string::npos;
    all.push_back({mixed ? 95.0 : size ? 46.0 : 24.0, (size ? "Small " : "") + warning + ".", "warnings"});
  }
  std::vector<std::string> unknown, vague, moved;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const Estimate& estimate = calibration.law.estimates[i];
    const std::string name = parameter_table()[i].name;
    const bool absent = estimate.note.starts_with("not part of");
    if (estimate.status == Status::not_identified && !absent) unknown.push_back(name);
    if (says_nothing(calibration.law, i)) vague.push_back(name);
    const double jackknife = fit::jackknife_error(calibration.left_out, i);
    if (jackknife > kJackknifeIsLarge * estimate.standard_error) moved.push_back(name);
  }
  const auto doubt = [&](double weight, const std::vector<std::string>& names, const char* what, const char* section) {
    if (!names.empty())
      all.push_back({weight,
                     fmt::format("{} of {} parameters {}: {}.", names.size(), kParameterCount, what, list_of(names)),
                     section});
  };
  doubt(55, unknown, "are not identified by these tests", "parameters");
  doubt(38, vague, "have an interval wider than themselves", "parameters");
  doubt(44, moved, "move by more than twice their stated error when one packing is left out", "checks");
}

void doubt_predictions(const ReportInput& input, const std::vector<PathError>& errors, std::vector<Reservation>& all) {
  if (std::ranges::none_of(errors, is_recommended)) {
    all.push_back({90,
                   "Nothing is known of its error: " +
                       (input.no_predictions.empty() ? std::string("no prediction stands beside DEM runs; grainlaw "
                                                                   "predict with --dem or --against makes one.")
                                                     : input.no_predictions),
                   "predictions"});
  }
  if (input.calibration.law.rehearsals.empty())
    all.push_back({62,
                   "What the law itself has wrong is in no band, as no path was rehearsed; grainlaw predict with "
                   "--rehearse keeps a path's runs for that.",
                   "predictions"});
  const auto& rehearsals = input.calibration.law.rehearsals;
  const auto known_packings = std::ranges::count_if(rehearsals, [](const Rehearsal& rehearsal) {
    // nothing is taken off for chance where packings are those of the fit (docs/theory/bands.md)
    return !rehearsal.rungs.empty() && rehearsal.rungs.front().P_star.rows > 0 &&
           rehearsal.rungs.front().P_star.known == 0;
  });
  if (known_packings > 0)
    all.push_back({47,
                   fmt::format("{} of {} rehearsals ran on packings whose other tests were fitted: along these the law "
                               "looks better than on new packings.",
                               known_packings, rehearsals.size()),
                   "predictions"});
  const PathError *worst = nullptr, *least_held = nullptr;
  std::size_t worst_of = 0, held_of = 0;
  for (const PathError& entry : errors) {
    if (!entry.recommended) continue;
    for (std::size_t q = 0; q < 3; ++q) {
      if (entry.error[q] > (worst == nullptr ? kGood : worst->error[worst_of])) worst = &entry, worst_of = q;
      if (entry.in_band[q] < (least_held == nullptr ? kLeastShare : least_held->in_band[held_of]))
        least_held = &entry, held_of = q;
    }
  }
  if (worst != nullptr)
    all.push_back({25 + 100 * std::min(0.5, worst->error[worst_of]),
                   fmt::format("Worst of the {} paths: {} along {} ({}) is {:.1f} % off.", paths_of(errors, any),
                               kNames[worst_of], worst->path, to_string(worst->kind), 100 * worst->error[worst_of]),
                   "unseen"});
  if (least_held != nullptr)
    all.push_back({30 + 100 * (0.95 - least_held->in_band[held_of]),
                   fmt::format("The 95 % band of a single run holds {:.0f} % of the rows of {} along {}.",
                               100 * least_held->in_band[held_of], kNames[held_of], least_held->path),
                   "unseen"});
  std::vector<std::string> untried;
  for (const PathKind kind : kValues<PathKind>) {
    if (std::none_of(errors.begin(), errors.end(), [=](const PathError& e) { return e.kind == kind; }))
      untried.push_back(to_string(kind));
  }
  if (!untried.empty() && !errors.empty())
    all.push_back(
        {45, fmt::format("Never tried: {} paths. Nothing here speaks for them.", list_of(untried)), "predictions"});
  for (const predict::PredictionFolder& prediction : input.predictions) {
    for (const std::string& warning : prediction.warnings) {
      const bool flatters = warning.find("packings that were fitted") != std::string::npos;
      all.push_back({flatters ? 47.0 : 36.0, prediction.name + ": " + warning + ".", "warnings"});
    }
    if (!prediction.failures.empty())
      all.push_back({52,
                     fmt::format("{}: {} of its curves are left out, the first as {}.", prediction.name,
                                 prediction.failures.size(), prediction.failures.front().error),
                     "predictions"});
  }
}

}  // namespace

int heat_of(double error) {
  if (!(error >= 0)) return -1;
  return static_cast<int>(std::lower_bound(kShades.begin(), kShades.end(), error) - kShades.begin());
}

std::vector<Reservation> reservations(const ReportInput& input, const std::vector<PathError>& errors) {
  std::vector<Reservation> all;
  doubt_fit(input, all);
  doubt_predictions(input, errors, all);
  const auto differ = std::count_if(input.modes.verdicts.begin(), input.modes.verdicts.end(),
                                    [](const fit::Verdict& verdict) { return verdict.verdict == "differs"; });
  if (differ > 0)
    all.push_back({20,
                   fmt::format("{} of {} published numbers and points of curves differ beyond chance.", differ,
                               input.modes.verdicts.size()),
                   "published"});
  all.push_back({3,
                 fmt::format("Data of {}, of one size distribution and at one strain rate: of others nothing is shown.",
                             kind_of_spheres(input)),
                 "quality"});
  all.push_back(
      {2, "The form of the law, and what of it is fixed by decision, is in no interval of a parameter.", "parameters"});
  const std::string other = fit::other_than_the_papers(input.tests);
  all.push_back({1,
                 other.empty() ? "The published numbers are of other packings and another preparation."
                               : fmt::format("The published numbers are of another material ({}).", other),
                 "published"});
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return all;
}

Paragraph verdict(const ReportInput& input, const std::vector<PathError>& errors) {
  if (!input.calibration.law.converged)
    return {plain("Do not use it yet: the fit did not converge, what follows is not its optimum."), Tone::poor};
  if (std::ranges::none_of(errors, is_recommended))
    return {plain("Not judged: no path was rehearsed, and no prediction of this law has an error beside runs. Its "
                  "parameters stand below; how well it predicts is not known."),
            Tone::poor};
  std::vector<std::string> clauses;
  std::set<PathKind> kinds;
  std::size_t worst = 0;
  for (const Rehearsed quantity : kValues<Rehearsed>) {
    std::array<std::vector<std::string>, kGrades.size()> by_grade;
    for (const PathKind kind : kValues<PathKind>) {
      const std::optional<std::size_t> grade = grade_of(errors, quantity, kind);
      if (!grade) continue;
      by_grade[*grade].push_back(to_string(kind));
      kinds.insert(kind);
      worst = std::max(worst, *grade);
    }
    // what most kinds are, and the exceptions
    const auto most = static_cast<std::size_t>(
        std::ranges::max_element(by_grade, {}, [](const auto& of) { return of.size(); }) - by_grade.begin());
    if (by_grade[most].empty()) {
      clauses.push_back(fmt::format("of {} nothing is known", kNames[static_cast<std::size_t>(quantity)]));
      continue;
    }
    std::string clause = fmt::format("{} {}", kNames[static_cast<std::size_t>(quantity)], kGrades[most]);
    for (std::size_t g = 0; g < by_grade.size(); ++g) {
      if (g != most && !by_grade[g].empty())
        clause += fmt::format(", {} on {} paths", kGrades[g], list_of(by_grade[g]));
    }
    clauses.push_back(clause);
  }
  constexpr std::array openings{"Usable as it is", "Usable with care", "Usable in part"};
  constexpr std::array tones{Tone::good, Tone::fair, Tone::poor};
  const std::string where = kinds.size() == 1 ? fmt::format(", on {} paths", to_string(*kinds.begin())) : "";
  return {plain(fmt::format("{}{}: {}. (Good: within 10 % of the largest value, rough: within 25 %, poor: beyond.)",
                            openings[worst], where, fmt::join(clauses, "; "))),
          tones[worst]};
}

Table errors_by_kind(const std::vector<PathError>& errors) {
  struct OfKind {
    PathKind kind;
    std::size_t paths;
    std::array<ErrorOverPaths, 3> over;
  };
  std::vector<OfKind> kinds;
  for (const PathKind kind : kValues<PathKind>) {
    const auto of_kind = [=](const PathError& entry) { return entry.kind == kind; };
    OfKind row{kind, paths_of(errors, of_kind), {}};
    for (const Rehearsed q : kValues<Rehearsed>)
      row.over[static_cast<std::size_t>(q)] = recommended_over(errors, q, of_kind);
    if (row.paths > 0) kinds.push_back(row);
  }
  const auto cell = [](std::size_t q) {
    return [q](const OfKind& row) {
      const double rms = row.over[q].paths > 0 ? row.over[q].rms : kUndefined;
      return Cell(error_text(row.over[q]), 100 * rms, heat_of(rms));
    };
  };
  return table_of(
      "By kind of path: error of the recommended rung and its range over the paths; predicted ones by their single "
      "runs, rehearsed ones by the mean of the runs",
      "", kinds,
      {{"kind (paths)", Content::words,
        [](const OfKind& row) { return Cell(fmt::format("{} ({})", to_string(row.kind), row.paths)); }},
       {"where", Content::words, [](const OfKind& row) { return kWhere[static_cast<std::size_t>(row.kind)]; }},
       {"{P}*", Content::number, cell(0)},
       {"{s}", Content::number, cell(1)},
       {"{F}", Content::number, cell(2)}});
}

std::vector<Block> first_screen(const ReportInput& input, const std::vector<PathError>& errors) {
  Block block{{subject(input), verdict(input, errors)}};
  if (!errors.empty()) {
    block.contents.emplace_back(error_tiles(input, errors));
    if (const Table kinds = errors_by_kind(errors); kinds.rows.size() > 1) block.contents.emplace_back(kinds);
  } else {
    block.contents.emplace_back(Tiles{"", {cost_tile(input)}});
  }
  const std::vector<Reservation> all = reservations(input, errors);
  Items three;
  for (std::size_t i = 0; i < 3; ++i) {
    three.lines.push_back(all[i].words);
    three.sections.push_back(all[i].section);
  }
  block.contents.emplace_back(Paragraph{plain("Distrust first:")});
  block.contents.emplace_back(three);
  return {block};
}

}  // namespace grainlaw::app::report
