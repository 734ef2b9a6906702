#pragma once
// study.json of a study of settings: dem, chain and fit alike (docs/schemas/study_settings.schema.json).

#include "app/files/json_document.hpp"
#include "app/study/settings_study.hpp"

namespace grainlaw::app {

OrderedJson study_to_json(const SettingsStudy& study);

}  // namespace grainlaw::app
