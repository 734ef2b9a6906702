#pragma once
// What the integration of a path costs at which error, by CVODE, by explicit methods and by substeps, on paths of three
// kinds; and many paths over the cores.

#include <string>
#include <vector>

#include "model/files/execution.hpp"
#include "model/files/json_document.hpp"
#include "predict/studies/work_precision.hpp"

namespace grainlaw::predict {

/// Many paths over the threads.
struct BatchTime {
  Integrator integrator = Integrator::adams;
  double accuracy = 0;  ///< as of a WorkPoint [-]
  double seconds = 0;   ///< of all paths together [s]
};

struct IntegratorStudy {
  LawParameters<double> parameters;
  Coupling coupling = Coupling::energy;
  std::string source;  ///< where the parameters are from: "published", or a file
  int repeats = 50;    ///< of each path; the least time counts
  int paths = 100000;  ///< of the batch
  int threads = 1;     ///< of the batch
  std::vector<WorkPrecision> panels = {};
  std::vector<BatchTime> batch = {};  ///< by CVODE, and by what was quickest on the first path
};

/// The published law with the measured A2, which the paper has not.
IntegratorStudy published_law_study();

/// Fills panels and batch of `study`. Throws Interrupted.
void measure(IntegratorStudy& study, const Execution& execution);

inline constexpr double kWantedError = 1e-6;  ///< of the goals in docs/performance.md [-]

/// study.json without its provenance.
OrderedJson study_to_json(const IntegratorStudy& study);

}  // namespace grainlaw::predict
