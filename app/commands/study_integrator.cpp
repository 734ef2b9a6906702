#include "app/commands/study_integrator.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "app/commands/study_output.hpp"
#include "chain/studies/study_json.hpp"
#include "model/parameters_file.hpp"
#include "model/files/output_folder.hpp"
#include "model/vocabulary/error.hpp"
#include "predict/studies/walker.hpp"
#include "predict/predict.hpp"
#include "predict/studies/work_precision.hpp"

namespace grainlaw::app {
namespace {

using predict::Integrator;

constexpr double kWantedError = 1e-6;  // of the goals in docs/performance.md
constexpr double kMeasuredA2 = 1.18;   // the paper has none; small-strain probes of quasi-static packings

struct BatchTime {
  Integrator integrator;
  double accuracy;
  double seconds;
};

struct StudiedLaw {
  LawParameters<double> parameters;
  Coupling coupling = Coupling::energy;
  std::string source;
};

StudiedLaw law_of(const StudyIntegratorOptions& options) {
  if (options.parameters.empty()) {
    StudiedLaw law{published_parameters(), Coupling::energy, "published"};
    law.parameters.anisotropy.a2 = kMeasuredA2;
    return law;
  }
  const ParametersFile file = read_parameters(options.parameters);
  require_parameters(file.law, Rung::evolution, options.parameters.string());
  return {file.law.parameters, file.law.coupling, options.parameters.string()};
}

/// UNI to nu = .82 from `count` densities in [.68, .74].
std::vector<predict::BatchPath> batch_paths(const LawParameters<double>& parameters, int count) {
  std::vector<predict::BatchPath> paths;
  for (int i = 0; i < count; ++i) {
    const double nu = 0.68 + 0.06 * i / count;
    paths.push_back(
        {resolve({nu, Branch::unloading, {{Mode::UNI, direction_of(Mode::UNI), ExtentKind::target_nu, 0.82}}}),
         predict::state_from_law(parameters, nu)});
  }
  return paths;
}

/// The batch by CVODE and by what was quickest on the smooth path.
std::vector<BatchTime> time_batch(const StudiedLaw& law, const predict::WorkPrecision& smooth,
                                  const StudyIntegratorOptions& options, const Session& session) {
  const auto paths = batch_paths(law.parameters, options.paths);
  std::vector<BatchTime> times;
  const Integrator adams = Integrator::adams;
  for (const predict::WorkPoint* point :
       {predict::quickest(smooth, kWantedError, &adams), predict::quickest(smooth, kWantedError)}) {
    if (!point) continue;
    const auto before = std::chrono::steady_clock::now();
    predict::walk_batch(paths, point->integrator, point->accuracy, law.parameters, Rung::evolution, law.coupling,
                        session.threads, {{}, session.stop});
    times.push_back({point->integrator, point->accuracy,
                     std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count()});
  }
  return times;
}

OrderedJson values_to_json(const LawParameters<double>& parameters) {
  OrderedJson values;
  const auto all = fields(parameters);
  for (std::size_t i = 0; i < kParameterCount; ++i) values[parameter_table()[i].name] = *all[i];
  return values;
}

OrderedJson point_to_json(const predict::WorkPoint& point) {
  return {{"integrator", to_string(point.integrator)},
          {"accuracy", point.accuracy},
          {"error", number_or_null(point.error)},
          {"rhs_evaluations", point.rhs_evaluations},
          {"steps", point.steps},
          {"microseconds", point.microseconds}};
}

OrderedJson panel_to_json(const predict::WorkPrecision& study) {
  OrderedJson points = OrderedJson::array(), quickest_points = OrderedJson::array();
  for (const predict::WorkPoint& point : study.points) points.push_back(point_to_json(point));
  for (const Integrator& integrator : predict::kIntegrators) {
    if (const predict::WorkPoint* point = predict::quickest(study, kWantedError, &integrator))
      quickest_points.push_back(point_to_json(*point));
  }
  return {{"path", study.path.name},
          {"description", study.path.description},
          {"reference", "erk_8 at 1e-13"},
          {"end",
           {{"P_star", study.end.P}, {"s_dev", study.end.sigma.norm() / study.end.P}, {"F_dev", study.end.F.norm()}}},
          {"reference_disagreement", number_or_null(study.reference_disagreement)},
          {"quickest_within_1e-6", quickest_points},
          {"points", points}};
}

OrderedJson batch_to_json(const std::vector<BatchTime>& times, int paths, int threads) {
  OrderedJson array = OrderedJson::array();
  for (const BatchTime& time : times) {
    array.push_back({{"integrator", to_string(time.integrator)},
                     {"accuracy", time.accuracy},
                     {"paths", paths},
                     {"threads", threads},
                     {"seconds", time.seconds},
                     {"paths_per_second", paths / time.seconds}});
  }
  return array;
}

report::Series series_of(const predict::WorkPrecision& study, Integrator integrator, bool time) {
  using namespace report;
  constexpr Marker markers[] = {Marker::circle,  Marker::square, Marker::triangle,
                                Marker::diamond, Marker::cross,  Marker::plus};
  const int i = static_cast<int>(integrator);
  Series series;
  series.label = plain(to_string(integrator));
  series.colour = static_cast<Colour>(i % kColourCount);
  series.marker = markers[static_cast<std::size_t>(i) % std::size(markers)];
  series.open_marker = i >= kColourCount;
  series.line = i < 2 ? Line::solid : integrator == Integrator::euler ? Line::dotted : Line::dashed;
  series.line_width = 1.2;
  for (const predict::WorkPoint& point : study.points) {
    if (point.integrator != integrator) continue;
    series.x.push_back(point.error);
    series.y.push_back(time ? point.microseconds : static_cast<double>(point.rhs_evaluations));
  }
  return series;
}

report::Figure figure_of(const std::vector<predict::WorkPrecision>& studies) {
  using namespace report;
  Figure figure;
  figure.id = "work-precision";
  figure.title = "Work against precision of the integrators";
  figure.description = "Right-hand sides and time of one path over the error reached, for each integrator";
  figure.columns = static_cast<int>(studies.size());
  figure.panel_height = 260;
  for (const bool time : {false, true}) {
    for (const predict::WorkPrecision& study : studies) {
      Panel panel;
      panel.title = plain(study.path.name);
      panel.x.label = plain("error [–]");
      panel.y.label = plain(time ? "time of a path [µs]" : "right-hand sides");
      panel.x.logarithmic = panel.y.logarithmic = true;
      panel.x.floor = 1e-13;
      for (const Integrator integrator : predict::kIntegrators)
        panel.series.push_back(series_of(study, integrator, time));
      figure.panels.push_back(panel);
    }
  }
  return figure;
}

std::string text_of(const std::vector<predict::WorkPrecision>& studies, const std::vector<BatchTime>& times, int paths,
                    int threads) {
  std::string text = fmt::format("least microseconds of a path with an error of at most {:.0e}\n", kWantedError);
  for (const predict::WorkPrecision& study : studies) {
    text += fmt::format("{}: {}\n", study.path.name, study.path.description);
    for (const Integrator& integrator : predict::kIntegrators) {
      const predict::WorkPoint* point = predict::quickest(study, kWantedError, &integrator);
      text += point ? fmt::format("  {:<7} {:8.1f} us  {:6} right-hand sides  error {:.1e}  (accuracy {:.1e})\n",
                                  to_string(integrator), point->microseconds, point->rhs_evaluations, point->error,
                                  point->accuracy)
                    : fmt::format("  {:<7} not reached\n", to_string(integrator));
    }
  }
  for (const BatchTime& time : times) {
    text += fmt::format("batch: {} paths on {} threads by {} at {:.0e}: {:.2f} s\n", paths, threads,
                        to_string(time.integrator), time.accuracy, time.seconds);
  }
  return text;
}

}  // namespace

ExitCode study_integrator(const StudyIntegratorOptions& options, Session& session) {
  const StudiedLaw law = law_of(options);
  make_output_folder(options.output);
  std::vector<predict::WorkPrecision> studies;
  for (const predict::StudyPath& path : predict::study_paths(law.parameters)) {
    session.watch.log("study of " + path.name);
    studies.push_back(predict::measure_work(path, law.parameters, Rung::evolution, law.coupling, options.repeats,
                                            {{}, session.stop}));
  }
  const std::vector<BatchTime> times = time_batch(law, studies.front(), options, session);

  OrderedJson document = chain::study_document("integrator");
  document["parameters"] = law.source;
  document["values"] = values_to_json(law.parameters);
  document["coupling"] = to_string(law.coupling);
  document["repeats"] = options.repeats;
  document["error"] = "largest of |dP|/P, |dsigma'|/P, |dF'| at the ends of the segments";
  OrderedJson& panels = document["panels"] = OrderedJson::array();
  for (const predict::WorkPrecision& study : studies) panels.push_back(panel_to_json(study));
  document["batch"] = batch_to_json(times, options.paths, session.threads);
  finish_study(options.output, document, "work_precision.svg", figure_of(studies),
               text_of(studies, times, options.paths, session.threads), session);
  return ExitCode::ok;
}

}  // namespace grainlaw::app
