// simulate, calibrate, predict, report: the commands of the program as functions, with their results as objects.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include "app/report/report.hpp"
#include "app/terminal/result_text.hpp"
#include "chain/calibration.hpp"
#include "chain/prediction.hpp"
#include "dem/runs/simulation.hpp"
#include "fit/prior_file.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/one_line.hpp"
#include "model/parameters_file.hpp"
#include "python/errors.hpp"
#include "python/inputs.hpp"
#include "python/objects.hpp"
#include "python/work.hpp"

namespace grainlaw::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;

/// grainlaw.Simulation.
struct Simulation {
  Series series;
  std::vector<std::string> warnings;
  OrderedJson summary = OrderedJson::object();
};

/// grainlaw.Calibration.
struct Calibration {
  std::shared_ptr<Law> law;
  std::shared_ptr<Dataset> dataset;
  std::vector<std::string> warnings;
  OrderedJson summary = OrderedJson::object();
  fs::path folder;
};

/// grainlaw.PredictionFolder.
struct Predicted {
  std::shared_ptr<const predict::PredictionFolder> content;
  fs::path folder;
};

Simulation simulate(const py::object& test, const py::object& output, const Wishes& wishes) {
  const dem::TestFile read = given(test, "test", dem::read_test, dem::test_from_document);
  const fs::path folder = file_of(output, "output");
  auto result = result_of(wishes, [&](const Execution& execution) { return dem::simulate(read, folder, execution); });
  return {{std::make_shared<std::vector<Observation>>(std::move(result.rows))}, result.warnings, result.summary};
}

/// What did not converge, in one line.
std::string unconverged(const fit::Calibration& calibration, const fs::path& folder) {
  std::vector<std::string> stages;
  for (const fit::Stage& stage : calibration.stages) {
    if (!stage.converged) stages.push_back(fmt::format("stage '{}': {}", stage.name, stage.termination));
  }
  return one_line(fmt::format("the fit did not converge: {}; {} and the attribute result hold what there is",
                              fmt::join(stages, "; "), (folder / "parameters.json").string()));
}

/// What the keyword arguments of calibrate() change of the options that the spec asks for.
struct FitWishes {
  std::optional<Coupling> coupling;
  fit::Loss loss = fit::Loss::squares;
  int starts = 1;
  bool checks = false;
  py::object prior;
};

FitWishes fit_wishes(const py::object& coupling, const py::object& loss, const py::object& starts, bool checks,
                     const py::object& prior) {
  FitWishes wishes{.coupling = {},
                   .loss = choice_of<fit::Loss>(loss, "loss"),
                   .starts = static_cast<int>(whole_number(starts, "starts", 1, 10000)),
                   .checks = checks,
                   .prior = prior};
  if (!coupling.is_none()) wishes.coupling = choice_of<Coupling>(coupling, "coupling");
  return wishes;
}

Calibration calibrate(const py::object& spec, const py::object& dataset, const py::object& output,
                      const FitWishes& fit_as, const Wishes& wishes) {
  std::optional<dem::Spec> read;
  std::string name = "spec";
  if (!spec.is_none()) {
    if (!py::isinstance<py::dict>(spec)) name = file_of(spec, "spec").string();
    read = given(spec, "spec", dem::read_spec, [](const Json& document, const fs::path&, const std::string& of) {
      return dem::spec_from_json(document, of);
    });
  }
  const fs::path from = file_or_none(dataset, "dataset"), folder = file_of(output, "output");
  const bool no_prior = py::isinstance<py::str>(fit_as.prior) && text_of(fit_as.prior, "prior") == "none";
  const fs::path prior = no_prior ? fs::path() : file_or_none(fit_as.prior, "prior");
  OrderedJson summary = OrderedJson::object();
  auto result = result_of(wishes, [&](const Execution& execution) {
    chain::CalibrationInput input = chain::calibration_input(read, name, from);
    fit::CalibrationOptions options = chain::fit_options_of(input, execution);
    options.loss = fit_as.loss;
    options.starts = fit_as.starts;
    options.profiles = fit_as.checks;
    options.coupling = fit_as.coupling.value_or(options.coupling);
    if (no_prior) options.prior.reset();
    if (!prior.empty()) options.prior = fit::read_prior(prior);
    auto made = chain::calibrate(std::move(input), options, folder, execution);
    summary = app::summary_of(made, folder, app::Session{execution});
    return made;
  });
  const fs::path file = folder / "parameters.json";
  Calibration calibration{std::make_shared<Law>(result.calibration.law, file, file.string()),
                          std::make_shared<Dataset>(std::move(result.dataset)), result.calibration.warnings, summary,
                          folder};
  if (!result.calibration.law.converged)
    raise_not_converged(unconverged(result.calibration, folder), py::cast(calibration));
  return calibration;
}

std::vector<std::uint64_t> seeds_of(const py::object& seeds) {
  std::vector<std::uint64_t> numbers;
  if (seeds.is_none()) return numbers;
  if (!py::isinstance<py::iterable>(seeds)) throw InvalidInput("seeds: give a list of integers");
  for (const auto& seed : seeds)
    numbers.push_back(
        static_cast<std::uint64_t>(whole_number(seed, "seeds", 0, std::numeric_limits<std::int64_t>::max())));
  return numbers;
}

/// What the law is compared with.
struct RunWishes {
  bool dem = false;
  py::object against, seeds, spec, store;
};

Predicted predict_path(const py::object& law, const py::object& path, const py::object& output, const py::object& model,
                       const py::object& start, const RunWishes& runs, const Wishes& wishes) {
  const auto read = law_of(law);
  if (read->file.empty()) throw InvalidInput("law: was changed since it was read; save() it and give the file");
  const auto along = path_of(path);
  chain::PredictionInput input = chain::prediction_input(read->file, along->file, along->name);
  if (parameters_to_json({input.law, {}}) != parameters_to_json({read->law, {}}))
    throw InvalidInput(
        fmt::format("law: {} has changed since it was read; read it again, or save() this law under another name",
                    read->file.string()));
  const fs::path folder = file_of(output, "output"), against = file_or_none(runs.against, "against");
  if (!model.is_none()) input.model = choice_of<Rung>(model, "model");
  if (!start.is_none()) input.initial = choice_of<predict::Initial>(start, "start");
  if (runs.dem && !against.empty()) throw InvalidInput("against: excludes dem; give one of them");
  if (!runs.dem && !(runs.seeds.is_none() && runs.spec.is_none() && runs.store.is_none()))
    throw InvalidInput("seeds, spec, store: are those of new runs; give dem=True too");
  if (runs.dem) {
    dem::Spec spec = py::isinstance<py::dict>(runs.spec)
                         ? dem::spec_from_json(document_of(runs.spec, "spec"), "spec")
                         : chain::spec_of_calibration(file_or_none(runs.spec, "spec"), read->file);
    input.new_runs = chain::new_runs(input, std::move(spec), seeds_of(runs.seeds), file_or_none(runs.store, "store"));
  }
  auto content = result_of(wishes, [&](const Execution& execution) {
    if (!against.empty()) input.finished_runs = chain::finished_runs(input, against);
    return chain::predict_path(input, folder, execution);
  });
  return {std::make_shared<predict::PredictionFolder>(std::move(content)), folder};
}

py::object report(const py::object& folder, const py::object& output, const py::object& compare) {
  const fs::path about = file_of(folder, "folder"), html = file_or_none(output, "output"),
                 other = file_or_none(compare, "compare");
  return to_python(result_of({}, [&](const Execution&) {
    if (!html.empty()) app::write_report(about, html, other);
    return app::report_json(about, other);
  }));
}

py::list curves_of(const Predicted& self) {
  py::list curves;
  for (const predict::PredictedCurve& curve : self.content->curves)
    curves.append(Curve{{self.content, &curve.prediction}, curve.initial, curve.seed});
  return curves;
}

void add_results(py::module_& module) {
  plain_class<Simulation>(module, "Simulation", "What simulate() has run.")
      .def_readonly("series", &Simulation::series)
      .def_readonly("warnings", &Simulation::warnings)
      .def_property_readonly("summary", [](const Simulation& self) { return to_python(self.summary); });
  plain_class<Calibration>(module, "Calibration", "What calibrate() has found.")
      .def_readonly("law", &Calibration::law)
      .def_readonly("dataset", &Calibration::dataset)
      .def_readonly("warnings", &Calibration::warnings)
      .def_property_readonly("summary", [](const Calibration& self) { return to_python(self.summary); })
      .def_property_readonly("folder", [](const Calibration& self) { return self.folder.string(); });
  plain_class<Predicted>(module, "PredictionFolder", "The curves of a path, and how far they are from runs.")
      .def(py::init([](const py::object& given) {
             const fs::path folder = file_of(given, "folder");
             return Predicted{std::make_shared<predict::PredictionFolder>(predict::read_prediction(folder)), folder};
           }),
           py::arg("folder"), "Of a prediction that was made before.")
      .def_property_readonly("curves", &curves_of)
      .def_property_readonly("recommended",
                             [](const Predicted& self) { return to_string(self.content->recommended.rung); })
      .def_property_readonly("comparisons",
                             [](const Predicted& self) { return to_python(fields_to_json(self.content->comparisons)); })
      .def_property_readonly("warnings", [](const Predicted& self) { return self.content->warnings; })
      .def_property_readonly(
          "summary", [](const Predicted& self) { return to_python(app::summary_of(*self.content, self.folder)); })
      .def_property_readonly("folder", [](const Predicted& self) { return self.folder.string(); });
}

}  // namespace

void add_commands(py::module_& module) {
  add_results(module);
  const py::object none = py::none();
  module.def(
      "simulate",
      [](const py::object& test, const py::object& output, const py::object& threads, const py::object& progress,
         bool resume) {
        return simulate(test, output, {threads, progress, resume, "grainlaw.simulate of Python"});
      },
      py::arg("test"), py::arg("output"), py::kw_only(), py::arg("threads") = none, py::arg("progress") = none,
      py::arg("resume") = true, "One packing or one element test in the DEM engine, as TEST says.");
  module.def(
      "calibrate",
      [](const py::object& spec, const py::object& dataset, const py::object& output, const py::object& coupling,
         const py::object& loss, const py::object& starts, bool checks, const py::object& prior,
         const py::object& threads, const py::object& progress, bool resume) {
        return calibrate(spec, dataset, output, fit_wishes(coupling, loss, starts, checks, prior),
                         {threads, progress, resume, "grainlaw.calibrate of Python"});
      },
      py::arg("spec") = none, py::arg("dataset") = none, py::kw_only(), py::arg("output"), py::arg("coupling") = none,
      py::arg("loss") = "squares", py::arg("starts") = 1, py::arg("checks") = false, py::arg("prior") = none,
      py::arg("threads") = none, py::arg("progress") = none, py::arg("resume") = true,
      "Packings and element tests of a spec, or a data set that is there, then the law's parameters.");
  module.def(
      "predict",
      [](const py::object& law, const py::object& path, const py::object& output, const py::object& model,
         const py::object& start, bool dem, const py::object& against, const py::object& seeds, const py::object& spec,
         const py::object& store, const py::object& threads, const py::object& progress, bool resume) {
        return predict_path(law, path, output, model, start, {dem, against, seeds, spec, store},
                            {threads, progress, resume, "grainlaw.predict of Python"});
      },
      py::arg("law"), py::arg("path"), py::arg("output"), py::kw_only(), py::arg("model") = none,
      py::arg("start") = none, py::arg("dem") = false, py::arg("against") = none, py::arg("seeds") = none,
      py::arg("spec") = none, py::arg("store") = none, py::arg("threads") = none, py::arg("progress") = none,
      py::arg("resume") = true, "The calibrated law along a path, with bands, beside runs of it where there are any.");
  module.def("report", &report, py::arg("folder"), py::arg("output") = none, py::kw_only(), py::arg("compare") = none,
             "The page about a calibration, where `output` names its file; returns all numbers on it.");
}

}  // namespace grainlaw::python
