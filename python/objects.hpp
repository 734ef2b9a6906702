#pragma once
// What Python's objects hold: values of the library that do not change any more, shared with the arrays that look into them.

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/calibrated_law.hpp"
#include "model/files/dataset.hpp"
#include "model/files/path_file.hpp"
#include "predict/predict.hpp"
#include "predict/prediction_files.hpp"

namespace grainlaw::python {

/// grainlaw.Path: read once for many predictions.
struct StrainPath {
  explicit StrainPath(PathFile read, std::string called);

  PathFile file;
  std::string name;                       ///< in messages
  std::vector<StraightSegment> segments;  ///< none where the law decides the strain
};

/// grainlaw.CalibratedLaw.
struct Law {
  Law(CalibratedLaw read, std::filesystem::path source, std::string called);

  CalibratedLaw law;
  std::filesystem::path file;  ///< where it stands; empty when it was changed since
  std::string name;            ///< in messages
  std::vector<Rung> rungs;     ///< those that are calibrated, the richest last
};

/// grainlaw.Prediction.
struct Curve {
  std::shared_ptr<const predict::Prediction> prediction;
  predict::Initial initial = predict::Initial::law;
  std::optional<std::uint64_t> seed;
  std::shared_ptr<const Law> law = nullptr;          ///< of one in memory: warnings are looked up when asked for
  std::shared_ptr<const StrainPath> path = nullptr;  ///< likewise
};

/// grainlaw.Series.
struct Series {
  std::shared_ptr<const std::vector<Observation>> rows;
};

/// grainlaw.Test: one of a data set.
struct Test {
  std::shared_ptr<const Dataset> dataset;
  std::size_t index = 0;

  const DatasetTest& get() const { return dataset->tests[index]; }
};

/// Of every class of the module: nobody derives from it, and its own class is Python's `type`.
template <class T, class... Holder>
pybind11::class_<T, Holder...> plain_class(pybind11::module_& module, const char* name, const char* doc) {
  return {module, name, pybind11::is_final(), pybind11::metaclass(reinterpret_cast<PyObject*>(&PyType_Type)), doc};
}

/// A Path as it is, or made of a dict or file.
std::shared_ptr<const StrainPath> path_of(pybind11::handle object);

/// A CalibratedLaw as it is, or read from parameters.json or the folder of a calibration.
std::shared_ptr<const Law> law_of(pybind11::handle object);

// The classes and functions of the module, in the order in which they know each other:
void add_series(pybind11::module_& module);    ///< Path, Series, Test, Dataset, Prediction
void add_law(pybind11::module_& module);       ///< Parameter, Batch, CalibratedLaw
void add_commands(pybind11::module_& module);  ///< simulate, calibrate, predict, report and their results

}  // namespace grainlaw::python
