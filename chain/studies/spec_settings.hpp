#pragma once
// The settings of a study that are SPECs: a base as it stands in its file, and the same with changed keys.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "chain/studies/settings_study.hpp"
#include "dem/runs/spec_file.hpp"
#include "model/files/dataset.hpp"
#include "model/files/execution.hpp"

namespace grainlaw::chain {

/// Parses "key=value" of the command line: a number or a list as in JSON, else text. Throws InvalidInput.
std::pair<std::string, Json> change_from(const std::string& text);
Changes changes_from(const std::vector<std::string>& texts);

/// `document` with `changes`. A key may lead into what is there, e.g. "tests[1].strain". Throws InvalidInput when there is
/// nothing at such a place, naming `name`.
Json changed(Json document, const Changes& changes, const std::string& name);

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
std::vector<SettingOutcome> outcomes_of(const std::vector<SpecSetting>& settings, std::size_t judged,
                                        const Execution& execution,
                                        const std::function<SettingOutcome(const SpecSetting&)>& show);

}  // namespace grainlaw::chain
