// What is read and what comes out: paths, series, data sets, predictions.

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "chain/prediction.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/path_json.hpp"
#include "python/columns.hpp"
#include "python/inputs.hpp"
#include "python/objects.hpp"

namespace grainlaw::python {
namespace {

namespace py = pybind11;

using Data = std::shared_ptr<Dataset>;  // Python's hold on one; nothing changes it

/// As PATH takes it: of a direction either the mode or the tensor.
py::object path_to_python(const Path& path) {
  OrderedJson json = path_to_json(path);
  for (std::size_t k = 0; k < path.segments.size(); ++k) {
    const PathSegment& segment = path.segments[k];
    if (segment.mode == Mode::tensor) continue;
    OrderedJson& written = json["segments"][k];
    const bool forward = segment.direction.tensor == direction_of(segment.mode).tensor;
    if (!segment.spin.isZero(0) ||
        (!forward && segment.direction.tensor != direction_of(segment.mode, "xyz", true).tensor)) {
      written.erase("mode");
      continue;
    }
    written.erase("rate_tensor");
    if (!forward) written["reverse"] = true;
  }
  return to_python(json);
}

/// With what else PATH says.
py::dict to_dict(const StrainPath& path) {
  py::dict document = path_to_python(path.file.path);
  if (!path.file.seeds.empty()) document["seeds"] = path.file.seeds;
  if (path.file.rows) document["rows"] = *path.file.rows;
  return document;
}

void add_path(py::module_& module) {
  plain_class<StrainPath, std::shared_ptr<StrainPath>>(module, "Path", "A strain path, read once for many predictions.")
      .def(py::init([](const py::object& source) { return std::make_shared<StrainPath>(*path_of(source)); }),
           py::arg("source"), "Of a dict or the path of a JSON file.")
      .def_property_readonly("nu", [](const StrainPath& self) { return self.file.path.nu; })
      .def_property_readonly("segments", [](const StrainPath& self) { return self.file.path.segments.size(); })
      .def("to_dict", &to_dict)
      .def("__repr__",
           [](const StrainPath& self) {
             return fmt::format("<Path {} from nu = {}, {} segments>", self.name, self.file.path.nu,
                                self.file.path.segments.size());
           })
      .def(py::pickle(
          [](const StrainPath& self) { return py::make_tuple(to_dict(self), self.name, self.file.warnings); },
          [](const py::tuple& state) {
            const auto path = std::make_shared<StrainPath>(*path_of(state[0]));
            path->name = state[1].cast<std::string>();
            path->file.warnings = state[2].cast<std::vector<std::string>>();
            return path;
          }));
}

void add_series_type(py::module_& module) {
  auto type = plain_class<Series>(module, "Series",
                                  "What was seen of a packing along a test: read-only arrays by the CSV's names.");
  add_columns<Observation>(
      type, [](const Series& self) -> const auto& { return *self.rows; });
  type.def("__repr__", [](const Series& self) { return fmt::format("<Series of {} rows>", self.rows->size()); });
}

void add_test(py::module_& module) {
  plain_class<Test>(module, "Test", "One element test of a data set.")
      .def_property_readonly("name", [](const Test& self) { return self.get().record.name; })
      .def_property_readonly("role", [](const Test& self) { return to_string(self.get().record.role); })
      .def_property_readonly("path", [](const Test& self) { return path_to_python(self.get().record.path); })
      .def_property_readonly("packing",
                             [](const Test& self) { return to_python(fields_to_json(self.get().record.packing)); })
      .def_property_readonly("warnings", [](const Test& self) { return self.get().warnings; })
      .def_property_readonly("series",
                             [](const Test& self) {
                               return Series{{self.dataset, &self.get().record.rows}};
                             })
      .def("__repr__", [](const Test& self) {
        return fmt::format("<Test {}, {}>", self.get().record.name, to_string(self.get().record.role));
      });
}

/// The test of this name; null when there is none.
py::object test_of(const Data& data, const std::string& name) {
  for (std::size_t i = 0; i < data->tests.size(); ++i) {
    if (data->tests[i].record.name == name) return py::cast(Test{data, i});
  }
  return {};
}

py::list names_of_tests(const Data& data) {
  py::list names;
  for (const DatasetTest& test : data->tests) names.append(test.record.name);
  return names;
}

void add_dataset(py::module_& module) {
  plain_class<Dataset, Data>(module, "Dataset", "The tests of a data set, by their names.")
      .def(py::init([](const py::object& folder) {
             const std::filesystem::path from = dataset_folder(file_of(folder, "folder"));
             const py::gil_scoped_release unlocked;
             return std::make_shared<Dataset>(read_dataset(from));
           }),
           py::arg("folder"), "Of a data set, a calibration or a prediction.")
      .def("keys", &names_of_tests)
      .def("__iter__", [](const Data& self) { return py::iter(names_of_tests(self)); })
      .def("__len__", [](const Data& self) { return self->tests.size(); })
      .def("__contains__", [](const Data& self, const py::object& name) { return names_of_tests(self).contains(name); })
      .def("__getitem__",
           [](const Data& self, const std::string& name) {
             py::object test = test_of(self, name);
             if (!test) throw py::key_error(name);
             return test;
           })
      .def_property_readonly("spec", [](const Data& self) { return to_python(OrderedJson(self->spec)); })
      .def_property_readonly("seeds", [](const Data& self) { return self->seeds; })
      .def_property_readonly("digest", [](const Data& self) { return self->digest; });
}

std::vector<std::string> warnings_of(const Curve& self) {
  std::vector<std::string> warnings;
  if (self.path) warnings = chain::warnings_along(self.law->law, self.path->file);
  warnings.insert(warnings.end(), self.prediction->warnings.begin(), self.prediction->warnings.end());
  return warnings;
}

void add_prediction(py::module_& module) {
  auto type = plain_class<Curve>(module, "Prediction", "The law along a path: read-only arrays by the CSV's names.");
  add_columns<predict::PredictedRow>(
      type, [](const Curve& self) -> const auto& { return self.prediction->rows; });
  type.def_property_readonly("model", [](const Curve& self) { return to_string(self.prediction->model); })
      .def_property_readonly("start", [](const Curve& self) { return to_string(self.initial); })
      .def_property_readonly("seed", [](const Curve& self) { return self.seed; })
      .def_property_readonly("unjammed", [](const Curve& self) { return self.prediction->unjammed; })
      .def_property_readonly("events",
                             [](const Curve& self) { return to_python(fields_to_json(self.prediction->events)); })
      .def_property_readonly("warnings", &warnings_of)
      .def_property_readonly("statistics",
                             [](const Curve& self) { return to_python(fields_to_json(self.prediction->statistics)); })
      .def("__repr__", [](const Curve& self) {
        return fmt::format("<Prediction by {}, {} rows>", to_string(self.prediction->model),
                           self.prediction->rows.size());
      });
}

}  // namespace

StrainPath::StrainPath(PathFile read, std::string called)
    : file(std::move(read)),
      name(std::move(called)),
      segments(law_decides(file.path) ? decltype(segments){} : resolve(file.path)) {}

std::shared_ptr<const StrainPath> path_of(py::handle object) {
  if (py::isinstance<StrainPath>(object)) return object.cast<std::shared_ptr<StrainPath>>();
  std::string name = "path";
  PathFile file = given(
      object, name,
      [&](const std::filesystem::path& from) {
        name = from.string();
        return read_path(from);
      },
      path_from_document);
  return std::make_shared<StrainPath>(std::move(file), name);
}

void add_series(py::module_& module) {
  add_path(module);
  add_series_type(module);
  add_test(module);
  add_dataset(module);
  add_prediction(module);
}

}  // namespace grainlaw::python
