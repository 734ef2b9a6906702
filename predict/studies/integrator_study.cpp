#include "predict/studies/integrator_study.hpp"

#include <chrono>

#include "model/files/fields_json.hpp"
#include "predict/predict.hpp"

namespace grainlaw::predict {
namespace {

constexpr double kMeasuredA2 = 1.18;  // the paper has none; small-strain probes of quasi-static packings

/// UNI to nu = .82 from `count` densities in [.68, .74].
std::vector<BatchPath> batch_paths(const LawParameters<double>& parameters, int count) {
  std::vector<BatchPath> paths;
  for (int i = 0; i < count; ++i) {
    const double nu = 0.68 + 0.06 * i / count;
    paths.push_back(
        {resolve({nu, Branch::unloading, {{Mode::UNI, direction_of(Mode::UNI), ExtentKind::target_nu, 0.82}}}),
         state_from_law(parameters, nu)});
  }
  return paths;
}

/// The batch by CVODE and by what was quickest on the smooth path.
std::vector<BatchTime> time_batch(const IntegratorStudy& study, const Execution& execution) {
  const auto paths = batch_paths(study.parameters, study.paths);
  const WorkPrecision& smooth = study.panels.front();
  std::vector<BatchTime> times;
  const Integrator adams = Integrator::adams;
  for (const WorkPoint* point : {quickest(smooth, kWantedError, &adams), quickest(smooth, kWantedError)}) {
    if (!point) continue;
    const auto before = std::chrono::steady_clock::now();
    walk_batch(paths, point->integrator, point->accuracy, study.parameters, Rung::evolution, study.coupling,
               study.threads, {{}, execution.stop});
    times.push_back({point->integrator, point->accuracy,
                     std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count()});
  }
  return times;
}

OrderedJson values_to_json(const LawParameters<double>& parameters) {
  OrderedJson values = OrderedJson::object();
  const auto all = fields(parameters);
  for (std::size_t i = 0; i < kParameterCount; ++i) values[parameter_table()[i].name] = *all[i];
  return values;
}

OrderedJson panel_to_json(const WorkPrecision& study) {
  OrderedJson quickest_points = OrderedJson::array();
  for (const Integrator& integrator : kIntegrators) {
    if (const WorkPoint* point = quickest(study, kWantedError, &integrator))
      quickest_points.push_back(fields_to_json(*point));
  }
  return {{"path", study.path.name},
          {"description", study.path.description},
          {"reference", "erk_8 at 1e-13"},
          {"end",
           {{"P_star", study.end.P}, {"s_dev", study.end.sigma.norm() / study.end.P}, {"F_dev", study.end.F.norm()}}},
          {"reference_disagreement", number_or_null(study.reference_disagreement)},
          {"quickest_within_1e-6", quickest_points},
          {"points", fields_to_json(study.points)}};
}

OrderedJson batch_to_json(const IntegratorStudy& study) {
  OrderedJson array = OrderedJson::array();
  for (const BatchTime& time : study.batch) {
    array.push_back({{"integrator", to_string(time.integrator)},
                     {"accuracy", time.accuracy},
                     {"paths", study.paths},
                     {"threads", study.threads},
                     {"seconds", time.seconds},
                     {"paths_per_second", study.paths / time.seconds}});
  }
  return array;
}

}  // namespace

IntegratorStudy published_law_study() {
  IntegratorStudy study{published_parameters(), Coupling::energy, "published"};
  study.parameters.anisotropy.a2 = kMeasuredA2;
  return study;
}

void measure(IntegratorStudy& study, const Execution& execution) {
  for (const StudyPath& path : study_paths(study.parameters)) {
    execution.watch.log("study of " + path.name);
    study.panels.push_back(
        measure_work(path, study.parameters, Rung::evolution, study.coupling, study.repeats, {{}, execution.stop}));
  }
  study.batch = time_batch(study, execution);
}

OrderedJson study_to_json(const IntegratorStudy& study) {
  OrderedJson document{{"format", "grainlaw study"}, {"format_version", 1}, {"study", "integrator"}};
  document["parameters"] = study.source;
  document["values"] = values_to_json(study.parameters);
  document["coupling"] = to_string(study.coupling);
  document["repeats"] = study.repeats;
  document["error"] = "largest of |dP|/P, |dsigma'|/P, |dF'| at the ends of the segments";
  OrderedJson& panels = document["panels"] = OrderedJson::array();
  for (const WorkPrecision& panel : study.panels) panels.push_back(panel_to_json(panel));
  document["batch"] = batch_to_json(study);
  return document;
}

}  // namespace grainlaw::predict
