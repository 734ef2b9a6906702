// grainlaw.CalibratedLaw: what the data say of the parameters, and the law in memory.

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "model/files/execution.hpp"
#include "model/parameters_file.hpp"
#include "predict/bands.hpp"
#include "predict/mixed_control.hpp"
#include "predict/studies/strain_batch.hpp"
#include "python/columns.hpp"
#include "python/inputs.hpp"
#include "python/objects.hpp"
#include "python/work.hpp"

namespace grainlaw::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;
using predict::Initial;

/// A parameter as the data determine it.
struct Parameter {
  std::size_t index;
  Estimate estimate;
  double value;  ///< the law's own

  const ParameterInfo& info() const { return parameter_table()[index]; }
  bool known() const { return estimate.status != Status::not_identified; }
};

std::optional<double> if_number(double value) {
  return std::isnan(value) ? std::nullopt : std::optional<double>(value);
}

Parameter parameter_of(const Law& self, std::size_t i) {
  return {i, self.law.estimates[i], *fields(self.law.parameters)[i]};
}

/// States at the ends of steps, [paths][steps].
struct Batch {
  std::vector<LawState<double>> states;
  py::ssize_t paths, steps;

  /// (paths, steps, 6) of a deviator.
  py::array components(const Deviator<double> LawState<double>::*part) const {
    py::array_t<double> computed({paths, steps, py::ssize_t{6}});
    double* out = computed.mutable_data();
    for (const LawState<double>& state : states) {
      const Eigen::Matrix3d tensor = tensor_of(state.*part);
      for (std::size_t c = 0; c < 6; ++c) *out++ = component(tensor, c);
    }
    return computed;
  }
};

/// The rung of the argument `model`, by default the richest that the law can serve.
Rung rung_of(const Law& self, py::handle model) {
  if (model.is_none() && !self.rungs.empty()) return self.rungs.back();
  const Rung rung = model.is_none() ? Rung::reduced : choice_of<Rung>(model, "model");
  if (std::ranges::find(self.rungs, rung) == self.rungs.end()) require_parameters(self.law, rung, self.name);
  return rung;
}

/// A prediction in memory, as the arguments ask for it.
struct Wanted {
  const CalibratedLaw& law;
  Rung rung;
  Initial initial;
  bool bands;
  const Path* path = nullptr;                              ///< where the law decides the strain
  const std::vector<StraightSegment>* segments = nullptr;  ///< elsewhere
  int per_segment = 0;
  std::vector<predict::OutputPoint> points = {};
  LawState<double> start = {};

  predict::Prediction made(const RunControl& control) const {
    if (path != nullptr)
      return predict::predict_by_law(rung, law.parameters, law.coupling, *path, start, per_segment, {}, law.range,
                                     control);
    if (!bands)
      return predict::predict(rung, law.parameters, law.coupling, *segments, start, points, {}, law.range, control);
    return predict::predict_with_bands(rung, law, *segments, start, initial == Initial::law, points, control);
  }

  /// Rows, times what each costs.
  std::size_t work() const {
    return (path != nullptr ? path->segments.size() * static_cast<std::size_t>(per_segment) : points.size()) *
           (bands ? uncertain_parameters(law).size() + 1 : 1);
  }
};

/// More than this is done on another thread, so that an interrupt is noticed; some 50 ms.
constexpr std::size_t kShortWork = 5000;

Curve carried_out(const Wanted& wanted) {
  Curve curve{nullptr, wanted.initial, {}};
  if (wanted.work() > kShortWork) {
    curve.prediction = result_of({.threads = py::int_(1)}, [&](const Execution& execution) {
      return std::make_shared<predict::Prediction>(wanted.made({{}, execution.stop}));
    });
  } else {
    const py::gil_scoped_release unlocked;
    curve.prediction = std::make_shared<predict::Prediction>(wanted.made({}));
  }
  return curve;
}

/// At the rows of a test.
Curve predicted_rows(const Law& self, const TestRecord& test, Rung rung, Initial initial, bool bands) {
  Wanted wanted{.law = self.law, .rung = rung, .initial = initial, .bands = bands};
  const std::vector<StraightSegment> segments = resolve(test.path);
  wanted.segments = &segments;
  wanted.points = predict::points_of(test);
  wanted.start = initial == Initial::law ? predict::state_from_law(self.law.parameters, test.path.nu)
                                         : predict::state_from_row(test.rows.front());
  Curve curve = carried_out(wanted);
  curve.seed = test.packing.seed;
  return curve;
}

/// At equal steps of a path.
Curve predicted_path(const Law& self, const StrainPath& path, Rung rung, int points, bool bands) {
  Wanted wanted{.law = self.law, .rung = rung, .initial = Initial::law, .bands = bands, .per_segment = points};
  wanted.start = predict::state_from_law(self.law.parameters, path.file.path.nu);
  if (!path.segments.empty()) {
    wanted.segments = &path.segments;
    wanted.points = predict::uniform_points(path.segments, points);
  } else if (bands) {
    throw InvalidInput(path.name + ": bands: there are none where the law decides the strain; leave them out");
  } else {
    wanted.path = &path.file.path;
  }
  return carried_out(wanted);
}

Curve predicted(const std::shared_ptr<Law>& self, py::handle path, py::handle model, py::handle points, bool bands,
                py::handle start) {
  const Rung rung = rung_of(*self, model);
  const Initial initial = choice_of<Initial>(start, "start");
  if (py::isinstance<Test>(path)) {
    if (!points.is_none()) throw InvalidInput("points: a Test is predicted at its own rows; leave points out");
    return predicted_rows(*self, path.cast<const Test&>().get().record, rung, initial, bands);
  }
  if (initial == Initial::measured)
    throw InvalidInput("start: 'measured' is that of a Test; give one in place of the path");
  const std::shared_ptr<const StrainPath> along = path_of(path);
  const auto each = points.is_none() ? predict::kCurvePoints : whole_number(points, "points", 1, 1'000'000);
  Curve curve = predicted_path(*self, *along, rung, static_cast<int>(each), bands);
  curve.law = self;
  curve.path = along;
  return curve;
}

Batch predicted_batch(const Law& self, py::handle strain, py::handle nu, py::handle model, py::handle accuracy,
                      const py::object& threads) {
  const auto strains = numbers_of(strain, "strain", 3);
  const py::ssize_t paths = strains.shape(0), steps = strains.shape(1);
  if (strains.shape(2) != 6)
    throw InvalidInput(
        fmt::format("strain: has the shape ({}, {}, {}); give (paths, steps, 6), the components xx, yy, zz, "
                    "yz, xz, xy",
                    paths, steps, strains.shape(2)));
  const bool scalar = py::isinstance<py::float_>(nu) || py::isinstance<py::int_>(nu) ||
                      (py::hasattr(nu, "ndim") && py::int_(nu.attr("ndim")).cast<int>() == 0);
  const std::vector<double> same(scalar ? static_cast<std::size_t>(paths) : 0, scalar ? finite_number(nu, "nu") : 0);
  const auto densities = scalar ? py::array_t<double>() : numbers_of(nu, "nu", 1);
  if (!scalar && densities.shape(0) != paths)
    throw InvalidInput(
        fmt::format("nu: has {} values for {} paths; give one for each, or one number", densities.shape(0), paths));
  const Rung rung = rung_of(self, model);
  const double tolerance = finite_number(accuracy, "accuracy");
  if (!(tolerance >= 1e-14 && tolerance < 1))
    throw InvalidInput(fmt::format("accuracy: got {}; give a number in [1e-14, 1)", tolerance));
  const predict::StrainBatch batch{static_cast<std::size_t>(paths), static_cast<std::size_t>(steps), strains.data(),
                                   scalar ? same.data() : densities.data()};
  return {result_of({.threads = threads},
                    [&](const Execution& execution) {
                      return predict::states_along(batch, self.law.parameters, rung, self.law.coupling, tolerance,
                                                   execution.threads, {{}, execution.stop});
                    }),
          paths, steps};
}

/// A law with other values, which no data speak for: they have no errors.
std::shared_ptr<Law> changed(const Law& self, const py::dict& values) {
  CalibratedLaw law = self.law;
  for (const auto& [key, value] : values) {
    const std::string name = text_of(key, "with_values");
    const std::size_t i = parameter_index(name);
    const ParameterInfo& info = parameter_table()[i];
    const double wanted = finite_number(value, name);
    if (!(wanted >= info.lower && wanted <= info.upper))
      throw InvalidInput(fmt::format("{}: {} is outside its bounds [{}, {}]", name, wanted, info.lower, info.upper));
    *fields(law.parameters)[i] = wanted;
    law.estimates[i] = {wanted, std::nan(""), Status::fixed, "set by hand", std::nan("")};
    law.covariance.row(static_cast<Eigen::Index>(i)).setZero();
    law.covariance.col(static_cast<Eigen::Index>(i)).setZero();
  }
  law.rehearsals.clear();
  law.dataset_digest.clear();
  return std::make_shared<Law>(std::move(law), fs::path(), self.name);
}

py::array covariance(const py::object& self) {
  const Eigen::MatrixXd& matrix = self.cast<const Law&>().law.covariance;
  constexpr auto number = static_cast<py::ssize_t>(sizeof(double));
  return looking_at(matrix.data(), {matrix.rows(), matrix.cols()}, {number, number * matrix.rows()}, self);
}

py::dict range_of(const Law& self) {
  const ValidRange& range = self.law.range;
  return py::dict(py::arg("nu") = py::make_tuple(range.nu_min, range.nu_max),
                  py::arg("eps_dev") = py::make_tuple(0.0, range.eps_dev_max),
                  py::arg("eps_vol") = py::make_tuple(0.0, range.eps_vol_max),
                  py::arg("shear_path") = py::make_tuple(0.0, range.shear_path_max));
}

void add_parameter(py::module_& module) {
  plain_class<Parameter>(module, "Parameter", "A parameter of the law as the data determine it; all are dimensionless.")
      .def_property_readonly("name", [](const Parameter& p) { return p.info().name; })
      .def_property_readonly("value",
                             [](const Parameter& p) { return p.known() ? std::optional(p.value) : std::nullopt; })
      .def_property_readonly("standard_error", [](const Parameter& p) { return if_number(p.estimate.standard_error); })
      .def_property_readonly("degrees_of_freedom",
                             [](const Parameter& p) { return if_number(p.estimate.degrees_of_freedom); })
      .def_property_readonly("interval",
                             [](const Parameter& p) -> std::optional<std::pair<double, double>> {
                               const double half = p.estimate.half_width();
                               if (!p.known() || !std::isfinite(half)) return std::nullopt;
                               return std::pair(p.value - half, p.value + half);
                             })
      .def_property_readonly("status", [](const Parameter& p) { return to_string(p.estimate.status); })
      .def_property_readonly("note", [](const Parameter& p) { return p.estimate.note; })
      .def_property_readonly("symbol", [](const Parameter& p) { return p.info().symbol; })
      .def_property_readonly("equation", [](const Parameter& p) { return p.info().equation; })
      .def_property_readonly("meaning", [](const Parameter& p) { return p.info().meaning; })
      .def_property_readonly("bounds", [](const Parameter& p) { return std::pair(p.info().lower, p.info().upper); })
      .def_property_readonly("published", [](const Parameter& p) { return p.info().published; })
      .def("__repr__", [](const Parameter& p) {
        return p.known()
                   ? fmt::format("<Parameter {} = {:.6g} ({})>", p.info().name, p.value, to_string(p.estimate.status))
                   : fmt::format("<Parameter {}: not identified>", p.info().name);
      });
}

void add_batch(py::module_& module) {
  plain_class<Batch>(module, "Batch", "The law's state at the end of each step of each path; zero while unjammed.")
      .def_property_readonly(
          "P_star",
          [](const py::object& self) {
            const Batch& batch = self.cast<const Batch&>();
            static const LawState<double> nothing{};
            const auto& first = batch.states.empty() ? nothing : batch.states.front();
            constexpr auto step = static_cast<py::ssize_t>(sizeof(LawState<double>));
            return looking_at(&first.P, {batch.paths, batch.steps}, {batch.steps * step, step}, self);
          })
      .def_property_readonly("sigma_dev", [](const Batch& batch) { return batch.components(&LawState<double>::sigma); })
      .def_property_readonly("fabric_dev", [](const Batch& batch) { return batch.components(&LawState<double>::F); });
}

}  // namespace

Law::Law(CalibratedLaw read, fs::path source, std::string called)
    : law(std::move(read)), file(std::move(source)), name(std::move(called)), rungs(calibrated_rungs(law)) {}

std::shared_ptr<const Law> law_of(py::handle object) {
  if (py::isinstance<Law>(object)) return object.cast<std::shared_ptr<Law>>();
  fs::path file = file_of(object, "law");
  if (fs::is_directory(file)) file /= "parameters.json";
  return std::make_shared<Law>(read_parameters(file).law, file, file.string());
}

void add_law(py::module_& module) {
  add_parameter(module);
  add_batch(module);
  const auto parameters = [](const Law& self) {
    py::dict all;
    for (std::size_t i = 0; i < kParameterCount; ++i) all[parameter_table()[i].name] = parameter_of(self, i);
    return all;
  };
  plain_class<Law, std::shared_ptr<Law>>(
      module, "CalibratedLaw", "A calibrated law: parameters.json, or the folder of a calibration. Immutable.")
      .def(py::init([](const py::object& file) { return std::make_shared<Law>(*law_of(file)); }), py::arg("file"))
      .def_property_readonly(
          "file", [](const Law& self) { return self.file.empty() ? py::none() : py::cast(self.file.string()); })
      .def_property_readonly("parameters", parameters)
      .def("__getitem__",
           [](const Law& self, const std::string& name) { return parameter_of(self, parameter_index(name)); })
      .def_property_readonly("covariance", &covariance)
      .def_property_readonly("range", &range_of)
      .def_property_readonly("coupling", [](const Law& self) { return to_string(self.law.coupling); })
      .def_property_readonly("converged", [](const Law& self) { return self.law.converged; })
      .def_property_readonly("dataset_digest", [](const Law& self) { return self.law.dataset_digest; })
      .def_property_readonly("bands", [](const Law& self) { return available_bands(self.law); })
      .def_property_readonly("models",
                             [](const Law& self) {
                               py::list names;
                               for (const Rung rung : self.rungs) names.append(to_string(rung));
                               return names;
                             })
      .def("with_values", &changed, py::arg("values"), "The law with these values, which have no errors then.")
      .def(
          "save",
          [](const Law& self, const py::object& file) {
            write_parameters(file_of(file, "file"),
                             {self.law, Json(provenance({.command = "CalibratedLaw.save of Python"}))});
          },
          py::arg("file"), "Writes parameters.json.")
      .def("predict", &predicted, py::arg("path"), py::arg("model") = py::none(), py::kw_only(),
           py::arg("points") = py::none(), py::arg("bands") = false, py::arg("start") = "law",
           "The law at points of each segment (200), or at the rows of a Test. grainlaw.predict writes files.")
      .def("predict_batch", &predicted_batch, py::arg("strain"), py::arg("nu"), py::arg("model") = py::none(),
           py::kw_only(), py::arg("accuracy") = 1e-8, py::arg("threads") = py::none(),
           "The law along many strain histories, from arrays of (paths, steps, 6) and (paths,).")
      .def("__repr__", [](const Law& self) { return fmt::format("<CalibratedLaw {}>", self.name); })
      .def(py::pickle(
          [](const Law& self) {
            return py::make_tuple(json_text(parameters_to_json({self.law, {}})), py::bytes(self.file.string()),
                                  self.name);
          },
          [](const py::tuple& state) {
            const Json document = parse_json(state[0].cast<std::string>(), "pickled law", JsonSource::own);
            return std::make_shared<Law>(parameters_from_json(document, "pickled law").law,
                                         fs::path(state[1].cast<std::string>()), state[2].cast<std::string>());
          }));
}

}  // namespace grainlaw::python
