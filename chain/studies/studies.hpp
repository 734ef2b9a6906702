#pragma once
// What settings of the program cost and how far their results are from a reference (docs/theory/studies.md): of the
// engine, of the whole chain from packings to a prediction, and of the fit alone.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "chain/studies/settings_study.hpp"
#include "chain/studies/spec_settings.hpp"
#include "model/files/execution.hpp"

namespace grainlaw::chain {

/// Settings of the engine on the same packings: what the tests of each packing show. `settings` by settings_of(): the
/// reference, the base that is judged, the variations. Throws InvalidInput where one has other seeds. Data sets and runs
/// go to `output`, where they are found again.
SettingsStudy study_engine(const std::vector<SpecSetting>& settings, const std::filesystem::path& output,
                           const Execution& execution);

/// Settings of the whole chain by the prediction along `path`; `judged` is the index of the base, the first setting the
/// reference. Throws InvalidInput where the reference predicts nothing.
SettingsStudy study_chain(const std::vector<SpecSetting>& settings, std::size_t judged, const Path& path,
                          const std::filesystem::path& output, const Execution& execution);

/// What a fit loses that leaves out a part of the data of the folder `dataset`, or weighs them otherwise, against the fit
/// of everything: by the prediction along `path`, without one by the laws. `vary`: KEY=VALUE, one setting each; none: the
/// usual ones (fit_choices.hpp). Runs no DEM. Throws InvalidInput for one packing, and where everything shows nothing.
SettingsStudy study_fit(const std::filesystem::path& dataset, const std::optional<Path>& path,
                        const std::vector<std::string>& vary, const std::filesystem::path& output,
                        const Execution& execution);

}  // namespace grainlaw::chain
