#pragma once
// study.json of a study of settings: dem, chain and fit alike (docs/schemas/study_settings.schema.json).

#include "model/files/json_document.hpp"
#include "chain/studies/settings_study.hpp"

namespace grainlaw::chain {

/// What study.json begins with.
OrderedJson study_document(const std::string& kind);

OrderedJson study_to_json(const SettingsStudy& study);

}  // namespace grainlaw::chain
