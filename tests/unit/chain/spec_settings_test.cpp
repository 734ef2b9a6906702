#include "chain/studies/spec_settings.hpp"

#include <gtest/gtest.h>

#include "model/vocabulary/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::chain {
namespace {

class SpecSettings : public testing::TemporaryFolder {
 protected:
  std::filesystem::path spec_ = put("spec.json", R"({"seeds": [1, 2, 3], "densities": [0.70, 0.74, 0.78],
    "tests": [{"mode": "ISO", "role": "calibration"}, {"mode": "D2", "role": "calibration"}]})");
};

TEST_F(SpecSettings, AreTheReferenceTheBaseAndOneForEachChange) {
  const auto settings = settings_of(spec_, {"strain_rate=69", "rows=400"},
                                    {"densities=[0.70,0.78]", "seeds=[1,2]", "tests[1].strain=0.2"});
  ASSERT_EQ(settings.size(), 5u);
  EXPECT_EQ(settings[0].name, "reference");
  EXPECT_EQ(settings[0].spec.preparation.drive.strain_rate, 69);
  EXPECT_EQ(settings[0].spec.preparation.rows, 400);
  EXPECT_EQ(settings[1].name, "base");
  EXPECT_TRUE(settings[1].changes.empty());
  // a changed list reaches the tests that take all densities
  EXPECT_EQ(settings[2].spec.tests[1].densities, (std::vector<double>{0.70, 0.78}));
  EXPECT_EQ(settings[1].spec.tests[1].densities, (std::vector<double>{0.70, 0.74, 0.78}));
  EXPECT_EQ(settings[3].spec.seeds, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(settings[4].spec.tests[1].strain, 0.2);
  EXPECT_EQ(settings[2].folder, "densities--0.70-0.78-");
  EXPECT_EQ(settings_of(spec_, {}, {"rows=50"}).front().name, "base");
}

TEST_F(SpecSettings, AreRefusedBeforeAnythingRuns) {
  for (const char* bad : {"seeds=[1]", "no_such_key=1", "rows=0", "tests[2].strain=0.1", "rows"})
    EXPECT_THROW(settings_of(spec_, {}, {bad}), InvalidInput) << bad;
  EXPECT_THROW(settings_of(spec_, {}, {"rows=50", "rows=50"}), InvalidInput);
}

TEST_F(SpecSettings, OneThatFailsShowsNothingAndTheOthersGoOn) {
  const auto settings = settings_of(spec_, {"rows=400"}, {"time_step_fraction=0.2", "rows=50"});
  Execution session{.threads = 1};
  std::string failing = "time_step_fraction=0.2";
  const auto show = [&](const SpecSetting& setting) -> SettingOutcome {
    if (setting.name == failing) throw Error("the results would be wrong");
    return {setting.name, setting.changes, {7, 1, 0}, setting.spec.seeds, {}, {}, 0, "", ""};
  };
  const std::vector<SettingOutcome> outcomes = outcomes_of(settings, 1, session, show);
  ASSERT_EQ(outcomes.size(), 4u);
  EXPECT_EQ(outcomes[2].name, failing);
  EXPECT_EQ(outcomes[2].note, "the results would be wrong");
  EXPECT_EQ(outcomes[2].cost.particle_steps, 0);
  EXPECT_EQ(outcomes[3].cost.particle_steps, 7);
  EXPECT_TRUE(outcomes[3].note.empty());
  for (const char* needed : {"reference", "base"}) {
    failing = needed;
    EXPECT_THROW(outcomes_of(settings, 1, session, show), Error) << needed;
  }
  const auto stopped = [](const SpecSetting& setting) -> SettingOutcome {
    if (setting.name == "rows=50") throw Interrupted("stopped");
    return {setting.name, {}, {}, {}, {}, {}, 0, "", ""};
  };
  EXPECT_THROW(outcomes_of(settings, 1, session, stopped), Interrupted);
}

}  // namespace
}  // namespace grainlaw::chain
