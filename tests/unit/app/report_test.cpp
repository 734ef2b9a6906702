#include "app/report/report.hpp"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "app/report/series.hpp"
#include "chain/report_input.hpp"
#include "chain/unseen_paths.hpp"
#include "fit/calibration_file.hpp"
#include "model/files/dataset.hpp"
#include "model/files/output.hpp"
#include "model/files/series_csv.hpp"
#include "model/parameters_file.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/report_scene.hpp"
#include "tests/support/well_formed.hpp"

namespace grainlaw::app {
namespace {

namespace fs = std::filesystem;

Dataset write_tests(const fs::path& folder, const std::vector<TestRecord>& tests) {
  fs::create_directories(folder);
  Dataset dataset;
  for (const TestRecord& test : tests) {
    write_series(folder / (test.name + ".csv"), test.rows);
    dataset.tests.push_back({test, "", "", {1000, 1e-8, 0.5}, {}});
  }
  dataset.seeds = report::seeds_of(tests);
  write_dataset_index(folder, dataset);
  return dataset;
}

/// The made-up scene as the commands would leave it on disk.
class ReportFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    dir_ = fs::path(::testing::TempDir()) /
           ("report-" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(dir_);
    chain::ReportInput scene = test::report_scene();
    const Dataset dataset = write_tests(dir_ / "dataset", scene.tests);
    scene.calibration.law.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
    scene.calibration.law.dataset_digest = dataset.digest;
    write_parameters(dir_ / "parameters.json", {scene.calibration.law, Json{{"version", "0.1.0"}}});
    fit::write_calibration(dir_ / "calibration.json", scene.calibration, {}, {}, {{"version", "0.1.0"}});
    for (predict::PredictionFolder& prediction : scene.predictions) {
      const fs::path folder = dir_ / "predictions" / prediction.name;
      prediction.dem = write_tests(folder / "dem", chain::dem_records(prediction));
      predict::write_prediction(folder, prediction);
    }
  }
  void TearDown() override { fs::remove_all(dir_); }

  std::string page() const {
    write_report(dir_, dir_ / "report.html");
    std::ifstream in(dir_ / "report.html");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }

  /// What write_report says while `file` is not there.
  std::string message_without(const std::string& file) const {
    fs::rename(dir_ / file, dir_ / "away");
    std::string message = "no error";
    try {
      write_report(dir_, dir_ / "report.html");
    } catch (const InvalidInput& error) {
      message = error.what();
    }
    EXPECT_FALSE(fs::exists(dir_ / "report.html"));
    fs::rename(dir_ / "away", dir_ / file);
    return message;
  }

  fs::path dir_;
};

int count(const std::string& text, const std::string& what) {
  int n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST_F(ReportFolder, OnePageWithEveryFigureAndNothingFromOutside) {
  const std::string html = page();
  EXPECT_EQ(test::first_markup_error(html), "");
  for (const char* id : {"density", "scaled", "modes", "sheared-pressure", "stress-ratio", "fabric", "shear-laws",
                         "residuals", "prediction-1", "prediction-2", "quality-isotropic", "quality-shear"}) {
    EXPECT_EQ(count(html, "<figure id=\"" + std::string(id) + "\">"), 1) << id;
  }
  EXPECT_EQ(count(html, "<figure "), 12);
  for (const char* outside : {" src=", "@import", "<link", "<iframe", "<img", "url(http", "href=\"http"}) {
    EXPECT_EQ(count(html, outside), 0) << outside;
  }
  EXPECT_EQ(count(html, "http"), count(html, "http://www.w3.org/2000/svg") + count(html, "http-equiv"));
}

TEST_F(ReportFolder, EveryLinkLeadsSomewhere) {
  const auto check = [](const std::string& html) {
    int links = 0;
    for (std::size_t at = html.find("href=\"#"); at != std::string::npos; at = html.find("href=\"#", at + 1)) {
      const std::string id = html.substr(at + 7, html.find('"', at + 7) - at - 7);
      EXPECT_NE(html.find("id=\"" + id + "\""), std::string::npos) << id;
      ++links;
    }
    EXPECT_GT(links, 10);
  };
  check(page());
  fs::remove_all(dir_ / "predictions");
  check(page());
}

/// How often `word` stands by itself, not inside a longer word.
int count_words(const std::string& text, const std::string& word) {
  const auto letter = [&](std::size_t i) {
    return i < text.size() && std::isalpha(static_cast<unsigned char>(text[i])) != 0;
  };
  int n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    if ((at == 0 || !letter(at - 1)) && !letter(at + word.size())) ++n;
  }
  return n;
}

/// `html` without the characters that numbers of figures are packed into, which may spell anything.
std::string without_packed_numbers(const std::string& html) {
  std::string out;
  std::size_t copied = 0;
  for (std::size_t at = html.find(",\""); at != std::string::npos; at = html.find(",\"", copied)) {
    const std::size_t end = html.find('"', at + 2);
    out += html.substr(copied, at - copied);
    copied = end == std::string::npos ? html.size() : end;
  }
  return out + html.substr(copied);
}

TEST_F(ReportFolder, NoNumberOfThePageIsUndefined) {
  const std::string html = without_packed_numbers(page());
  for (const char* word : {"nan", "NaN", "inf", "Infinity"}) EXPECT_EQ(count_words(html, word), 0) << word;
}

TEST_F(ReportFolder, EveryMissingFileNamesTheCommandThatMakesIt) {
  for (const char* file :
       {"parameters.json", "calibration.json", "dataset/dataset.json", "dataset/D2-0.700-seed1.csv"}) {
    const std::string message = message_without(file);
    EXPECT_NE(message.find(file), std::string::npos) << message;
    EXPECT_NE(message.find("grainlaw calibrate SPEC.json -o " + dir_.string()), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  for (const char* file :
       {"predictions/uniaxial-0.695/prediction.json", "predictions/uniaxial-0.695/comparison.json",
        "predictions/uniaxial-0.695/dem/dataset.json", "predictions/uniaxial-0.695/evolution-law-seed12.csv"}) {
    const std::string message = message_without(file);
    EXPECT_NE(message.find(file), std::string::npos) << message;
    EXPECT_NE(message.find("grainlaw predict"), std::string::npos) << message;
    EXPECT_NE(message.find("predictions/uniaxial-0.695"), std::string::npos) << message;
  }
}

TEST_F(ReportFolder, ParametersThatAreNotIdentifiedAreWordsAndDrawNoCurve) {
  ParametersFile parameters = read_parameters(dir_ / "parameters.json");
  for (const char* name : {"stress_ratio_max.alpha", "steady_pressure.p0"}) {
    parameters.law.estimates[parameter_index(name)] = {std::nan(""), std::nan(""), Status::not_identified,
                                                       "one density"};
  }
  write_parameters(dir_ / "parameters.json", parameters);
  const std::string html = page();
  EXPECT_EQ(test::first_markup_error(html), "");
  EXPECT_NE(html.find("Eq. 20 not identified by these tests"), std::string::npos);
  EXPECT_NE(summary_table(dir_).find("not identified"), std::string::npos);
  EXPECT_EQ(count_words(without_packed_numbers(html), "nan"), 0);
}

TEST_F(ReportFolder, EveryFigureOfThePageIsInItsJsonWithItsCommand) {
  const std::string html = page();
  const OrderedJson json = report_json(dir_);
  int figures = 0, points = 0;
  for (const auto& section : json["sections"]) {
    for (const auto& content : section["contents"]) {
      if (!content.contains("figure")) continue;
      ++figures;
      EXPECT_EQ(count(html, "<figure id=\"" + content["figure"].get<std::string>() + "\">"), 1);
      for (const auto& panel : content["panels"]) {
        for (const auto& series : panel["series"]) points += static_cast<int>(series["y"].size());
      }
    }
  }
  EXPECT_EQ(figures, count(html, "<figure "));
  EXPECT_GT(points, 1000);
}

TEST_F(ReportFolder, WithoutPredictionsThePageSaysWhatIsMissing) {
  fs::remove_all(dir_ / "predictions");
  const std::string html = page();
  EXPECT_EQ(test::first_markup_error(html), "");
  EXPECT_NE(html.find("Not judged"), std::string::npos);
  EXPECT_NE(html.find("grainlaw predict " + (dir_ / "parameters.json").string()), std::string::npos);
  ParametersFile parameters = read_parameters(dir_ / "parameters.json");
  parameters.law.estimates[parameter_index("stress_rate.Q_c")] = {std::nan(""), std::nan(""), Status::not_identified,
                                                                  "one density"};
  write_parameters(dir_ / "parameters.json", parameters);
  EXPECT_NE(page().find("No prediction can be made"), std::string::npos);
}

TEST_F(ReportFolder, SpheresOfAnotherMaterialStandBesideThePapersAsSuch) {
  const std::string words = "The published numbers are of another material (size_width of its packing: 1, but 3)",
                    beside = words + ": on none of them is there a verdict.", sizes = "(largest over smallest radius ",
                    rest = "most of it because its error is wider";
  chain::ReportInput scene = test::report_scene();
  scene.calibration.law.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
  fit::ModeComparison modes;
  modes.verdicts = fit::verdicts_of(scene.calibration.law, {}, 2);
  fit::write_calibration(dir_ / "calibration.json", scene.calibration, {}, modes, {{"version", "0.1.0"}});
  std::string html = page();
  EXPECT_NE(html.find("id=\"published\""), std::string::npos);
  EXPECT_NE(html.find(sizes + "3)"), std::string::npos);
  EXPECT_EQ(html.find(words), std::string::npos);
  EXPECT_NE(html.find(rest), std::string::npos);
  fs::remove_all(dir_ / "predictions");
  for (TestRecord& test : scene.tests) test.packing.size_width = 1;
  write_tests(dir_ / "dataset", scene.tests);
  html = page();
  EXPECT_NE(html.find(sizes + "1)"), std::string::npos);
  EXPECT_NE(html.find(words + "."), std::string::npos) << "among the reasons for distrust";
  EXPECT_NE(html.find(beside), std::string::npos) << "at the head of the section";
  EXPECT_EQ(html.find(rest), std::string::npos) << "what has no verdict has it for another reason";
}

TEST_F(ReportFolder, TheDecisionComesBeforePredictionsAndTheseBeforeParameters) {
  const std::string html = page();
  std::size_t before = 0;
  for (const char* words :
       {"Calibrated from grains: 2 packings of 2000 frictionless spheres", "class=\"verdict", "class=\"tiles\"",
        "Distrust first:", "<nav", "id=\"unseen\"", "id=\"prediction-1\"", "id=\"parameters\"", "id=\"choices\"",
        "id=\"checks\"", "id=\"warnings\"", "id=\"provenance\""}) {
    const std::size_t at = html.find(words, before);
    ASSERT_NE(at, std::string::npos) << words;
    before = at;
  }
  EXPECT_NE(html.find("href=\"#prediction-2\""), std::string::npos) << "the table leads to the figures";
}

TEST_F(ReportFolder, AnotherCalibrationStandsBeside) {
  write_report(dir_, dir_ / "report.html", dir_);
  std::ifstream in(dir_ / "report.html");
  const std::string html{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(test::first_markup_error(html), "");
  EXPECT_NE(html.find("0 of "), std::string::npos) << "no parameter differs from itself";
  EXPECT_NE(html.find("id=\"comparison\""), std::string::npos);
}

TEST_F(ReportFolder, ErrorAgainstCostIsDrawnWhereAStudyIsThere) {
  EXPECT_NE(page().find("grainlaw study chain SPEC.json"), std::string::npos);
  const Json setting{{"setting", "base"},
                     {"particle_steps", 1e9},
                     {"seconds", 1},
                     {"fit_seconds", 1},
                     {"energy_residual", 1e-4},
                     {"note", ""},
                     {"error", 0.1},
                     {"floor", 0.05},
                     {"sampling", 0.05},
                     {"noise", 0.06},
                     {"reached", 0.1},
                     {"reached_standard_error", 0.01},
                     {"dominated_by", Json::array()}};
  fs::create_directories(dir_ / "studies" / "steps");
  write_json(dir_ / "studies" / "steps" / "study.json", OrderedJson{{"format", "grainlaw study"},
                                                                    {"study", "chain"},
                                                                    {"base", nullptr},
                                                                    {"error", "in words"},
                                                                    {"default", {{"setting", "base"}}},
                                                                    {"settings", Json::array({setting})}});
  const std::string html = page();
  EXPECT_EQ(count(html, "<figure id=\"settings-1\">"), 1);
  EXPECT_NE(html.find("studies/steps/study.json"), std::string::npos);
}

TEST_F(ReportFolder, TheSummaryIsARectangleOfText) {
  std::istringstream lines(summary_table(dir_));
  std::string line;
  int rows = 0;
  std::size_t width = 0;
  while (std::getline(lines, line)) {
    std::size_t characters = 0;
    for (const char c : line) characters += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    if (rows == 0) width = characters;
    EXPECT_EQ(characters, width) << line;
    ++rows;
  }
  EXPECT_EQ(rows, static_cast<int>(kParameterCount) + 2);
}

TEST_F(ReportFolder, AnotherDataSetThanTheFittedOneIsSaid) {
  ParametersFile parameters = read_parameters(dir_ / "parameters.json");
  parameters.law.dataset_digest[0] = parameters.law.dataset_digest[0] == '0' ? '1' : '0';
  write_parameters(dir_ / "parameters.json", parameters);
  EXPECT_NE(page().find("another data set"), std::string::npos);
}

TEST_F(ReportFolder, PredictionsOfAnotherLawCountNowhere) {
  const fs::path file = dir_ / "predictions" / "uniaxial-0.728" / "prediction.json";
  const auto errors_with = [&](const Json& parameters) {
    Json document = read_json(file, JsonSource::own);
    document["parameters"] = parameters;
    write_durably(file, document.dump());
    const chain::ReportInput input = chain::read_report_input(dir_);
    const auto errors = errors_on_unseen_paths(input);
    const bool counts = std::ranges::any_of(errors, [](const auto& e) { return e.path == "uniaxial-0.728"; });
    return std::pair{counts, input.warnings.size()};
  };
  const CalibratedLaw law = read_parameters(dir_ / "parameters.json").law;
  EXPECT_EQ(errors_with({{"sha256", "of another file"}, {"law_sha256", "of another law"}}), std::pair(false, 1ul));
  EXPECT_EQ(errors_with({{"sha256", "of another file"}}), std::pair(false, 1ul)) << "as earlier programs wrote it";
  EXPECT_EQ(errors_with({{"sha256", "before a rehearsal"}, {"law_sha256", law_digest(law)}}), std::pair(true, 0ul));
  CalibratedLaw rehearsed = law;
  rehearsed.rehearsals.emplace_back().name = "new";
  EXPECT_EQ(law_digest(rehearsed), law_digest(law));
  rehearsed.parameters.isotropic.pressure.p0 *= 1.1;
  EXPECT_NE(law_digest(rehearsed), law_digest(law));
}

}  // namespace
}  // namespace grainlaw::app
