#pragma once
// What a data set says when it is calibrated as a whole: the laws, and a prediction by the richest rung that it allows.

#include <map>
#include <optional>
#include <vector>

#include "chain/studies/settings_study.hpp"
#include "fit/data/options.hpp"
#include "model/files/execution.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::chain {

/// Densities, ascending, at which the calibration tests are sheared at constant volume.
std::vector<double> shear_densities(const Dataset& dataset);

/// The path in `file` along which a study predicts. Throws InvalidInput for one whose strain the law decides: two laws have no
/// rows at one strain.
Path study_path(const std::filesystem::path& file);

/// The setting `name`: quantities of the laws at `densities`, which with `path` are shown only, and the prediction along it.
/// What the data cannot carry is missing, and the note says why.
SettingOutcome calibrated_setting(const std::string& name, const Changes& changes, const Dataset& dataset,
                                  const fit::CalibrationOptions& options, const std::vector<double>& densities,
                                  const std::optional<Path>& path, const Execution& execution);

/// The reference of a study as some of its packings show it. A setting with fewer packings differs from the whole reference by their
/// chance, too, which linear errors foresee only roughly; beside the reference's own tests of the same packings it differs by what
/// the setting does, and that is all its error should contain: chance is counted as sampling.
class ReferenceByPackings {
 public:
  /// Of `reference`, which calibrated as a whole has shown `whole`; the others as in calibrated_setting().
  ReferenceByPackings(Dataset reference, SettingOutcome whole, fit::CalibrationOptions options,
                      std::vector<double> densities, std::optional<Path> path);

  /// What the reference's tests of the packings of `dataset` show. Empty, so that the whole reference is compared with, if it has
  /// no others, does not have all of these (same seed, number, sizes and stiffness), or predicts by a richer model than they allow.
  std::vector<StudyQuantity> quantities(const Dataset& dataset, const Execution& execution);

 private:
  Dataset reference_;
  SettingOutcome whole_;
  fit::CalibrationOptions options_;
  std::vector<double> densities_;
  std::optional<Path> path_;
  std::map<std::vector<std::uint64_t>, SettingOutcome> found_;  // by seeds
};

}  // namespace grainlaw::chain
