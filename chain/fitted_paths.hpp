#pragma once
// The law along the paths of the shear tests that a calibration was made of: fitted_paths.json beside parameters.json, what is
// drawn over those tests. From the law's own start, every rung that has its parameters, with all that the mode of shear asks for.

#include <filesystem>
#include <optional>
#include <vector>

#include "model/calibrated_law.hpp"
#include "model/files/execution.hpp"
#include "model/files/json_document.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::chain {

/// One rung along one path, at even steps.
struct FittedCurve {
  Rung model = Rung::evolution;
  std::vector<double> eps_dev, P_star, s_par, F_par;  ///< row by row, as in PredictedRow [-]
};
GRAINLAW_FIELDS(FittedCurve, model, eps_dev, P_star, s_par, F_par);

struct FittedPath {
  Path path;
  std::vector<FittedCurve> curves;   ///< cheapest rung first; one on which the law does not converge is missing
  Rung recommended = Rung::reduced;  ///< what rehearsals say now; in no file
};

/// Of every path of pure shear among `tests`, once.
std::vector<FittedPath> fitted_paths(const CalibratedLaw& law, const std::vector<TestRecord>& tests,
                                     const Execution& execution);

void write_fitted_paths(const std::filesystem::path& file, const std::vector<FittedPath>& paths,
                        const OrderedJson& provenance);

/// With the rung that `law` recommends; empty where the file is missing, as in folders of earlier programs. Throws InvalidInput.
std::vector<FittedPath> read_fitted_paths(const std::filesystem::path& file, const CalibratedLaw& law);

/// The rung that is recommended along `path`, and nothing where the law can serve none.
std::optional<Rung> recommended_along(const CalibratedLaw& law, const Path& path);

}  // namespace grainlaw::chain
