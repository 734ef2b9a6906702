#include "chain/studies/spec_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "dem/runs/dataset_runs.hpp"
#include "model/files/one_line.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

constexpr std::size_t kLongestFolder = 100;  // of a safe name

std::string folder_of(const std::string& name) {
  std::string folder = name.substr(0, kLongestFolder);
  std::replace_if(
      folder.begin(), folder.end(), [](char c) { return !is_safe_name(std::string("a") + c + "a"); }, '-');
  return is_safe_name(folder) ? folder : "setting" + folder.substr(0, kLongestFolder - 7);
}

/// "tests[1].strain" as a JSON pointer: /tests/1/strain
Json::json_pointer pointer_to(const std::string& key) {
  std::string path = "/";
  for (const char c : key) {
    if (c == ']') continue;
    path += c == '.' || c == '[' ? '/' : c;
  }
  return Json::json_pointer(path);
}

bool has_place(const Json& document, const Json::json_pointer& place) {
  if (!document.contains(place.parent_pointer())) return false;
  return document.at(place.parent_pointer()).is_object();
}

}  // namespace

std::pair<std::string, Json> change_from(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0 || at + 1 == text.size())
    throw InvalidInput(fmt::format("'{}': is no change; give KEY=VALUE", one_line(text, 100)));
  const std::string value = text.substr(at + 1);
  const Json parsed = Json::parse(value, nullptr, false);
  return {text.substr(0, at), parsed.is_number() || parsed.is_boolean() || parsed.is_array() ? parsed : Json(value)};
}

Changes changes_from(const std::vector<std::string>& texts) {
  Changes changes;
  for (const std::string& text : texts) changes.push_back(change_from(text));
  return changes;
}

Json changed(Json document, const Changes& changes, const std::string& name) {
  for (const auto& [key, value] : changes) {
    try {
      const Json::json_pointer place = pointer_to(key);
      if (!has_place(document, place)) throw InvalidInput("");
      document[place] = value;
    } catch (const std::exception&) {
      throw InvalidInput(
          fmt::format("{}: {}: there is no such place to change; name a key, or one of an entry that is "
                      "there, e.g. tests[1].strain",
                      one_line(name, 100), one_line(key, 100)));
    }
  }
  return document;
}

SpecSetting setting_of(const std::string& name, const Json& base, const Changes& changes) {
  const std::string shown = one_line(name, 100);
  return {name, changes, dem::spec_from_json(changed(base, changes, shown), shown), folder_of(name)};
}

std::vector<SpecSetting> settings_of(const std::filesystem::path& spec, const std::vector<std::string>& reference,
                                     const std::vector<std::string>& vary) {
  dem::read_spec(spec);  // complains by the file's name
  const Json base = read_json(spec, JsonSource::user);
  std::vector<SpecSetting> settings;
  if (!reference.empty()) settings.push_back(setting_of("reference", base, changes_from(reference)));
  settings.push_back(setting_of("base", base, {}));
  for (const std::string& text : vary) settings.push_back(setting_of(text, base, {change_from(text)}));
  std::set<std::string> folders;
  for (const SpecSetting& setting : settings) {
    const std::string name = one_line(setting.name, 100);
    if (!folders.insert(setting.folder).second)
      throw InvalidInput(fmt::format("{}: is given twice, or differs too little in its name from another", name));
    if (setting.spec.seeds.size() < 2)
      throw InvalidInput(fmt::format("{}: seeds: one packing has no scatter; give two or more", name));
  }
  return settings;
}

Dataset run_setting(const SpecSetting& setting, const std::filesystem::path& output, const Execution& execution) {
  execution.watch.log("setting " + setting.name);
  std::vector<dem::PlannedTest> tests = plan(setting.spec);
  std::erase_if(tests, [](const dem::PlannedTest& test) { return test.role != Role::calibration; });
  dem::RunCounts counts;
  return dem::run_planned(tests, Json(dem::spec_to_json(setting.spec)),
                          make_subfolder(make_subfolder(output, "data"), setting.folder), dem::RunStore(output, "runs"),
                          execution, counts);
}

std::vector<SettingOutcome> outcomes_of(const std::vector<SpecSetting>& settings, std::size_t judged,
                                        const Execution& execution,
                                        const std::function<SettingOutcome(const SpecSetting&)>& show) {
  std::vector<SettingOutcome> outcomes;
  for (const SpecSetting& setting : settings) {
    try {
      outcomes.push_back(show(setting));
    } catch (const Interrupted&) {
      throw;
    } catch (const Error& error) {
      if (outcomes.size() <= judged) throw;
      execution.watch.log(fmt::format("{} fails: {}", setting.name, one_line(error.what(), 300)));
      outcomes.push_back({setting.name, setting.changes, {}, setting.spec.seeds, {}, {}, 0, "", error.what()});
    }
  }
  return outcomes;
}

}  // namespace grainlaw::chain
