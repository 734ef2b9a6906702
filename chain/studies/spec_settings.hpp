#pragma once
// The settings of a study that are SPECs: a base as it stands in its file, and the same with changed keys.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "model/files/dataset.hpp"
#include "dem/runs/spec_file.hpp"
#include "model/files/execution.hpp"
#include "chain/studies/key_changes.hpp"
#include "chain/studies/settings_study.hpp"

namespace grainlaw::chain {

struct SpecSetting {
  std::string name;  ///< "base", "reference", "time_step_fraction=0.2", ...
  Changes changes;   ///< of the base
  dem::Spec spec;
  std::string folder;  ///< of its data set, made from the name
};

/// `base` with `changes`. Throws InvalidInput naming what the SPEC refuses.
SpecSetting setting_of(const std::string& name, const Json& base, const Changes& changes);

/// The reference (`reference` together; without any there is none), the base, and one for each of `vary`. Throws
/// InvalidInput, too, for a setting that is given twice or has fewer than two seeds: one packing has no scatter.
std::vector<SpecSetting> settings_of(const std::filesystem::path& spec, const std::vector<std::string>& reference,
                                     const std::vector<std::string>& vary);

/// Runs the setting's calibration tests; data sets go to `output`/data, runs to `output`/runs, where they are found again.
Dataset run_setting(const SpecSetting& setting, const std::filesystem::path& output, const Execution& execution);

/// What each setting has shown, by `show`. One after `judged` that fails, as a time step does that the engine refuses to go on
/// with, shows nothing but its note; the study goes on.
std::vector<SettingOutcome> outcomes_of(const std::vector<SpecSetting>& settings, std::size_t judged, const Execution& execution,
                                        const std::function<SettingOutcome(const SpecSetting&)>& show);

}  // namespace grainlaw::chain
