#include "chain/studies/fit_choices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

constexpr double kChoiceRounding = 1e-9;  // of strain

void keep_rows(std::vector<Observation>& rows, std::size_t every) {
  std::vector<Observation> kept;
  std::size_t first = 0;  // of the segment: the last row of the one before
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool corner = i == 0 || i + 1 == rows.size() || rows[i + 1].segment != rows[i].segment;
    if (corner || (i - first) % every == 0) kept.push_back(rows[i]);
    if (corner) first = i;
  }
  rows = kept;
}

void keep_packings(Dataset& dataset, std::size_t count) {
  const std::uint64_t last = packings_of(dataset).at(count - 1);
  std::erase_if(dataset.tests, [&](const DatasetTest& test) { return test.record.packing.seed > last; });
}

/// Paths that differ in their density only have one text.
std::string path_without_density(const Path& path) {
  std::string text = to_string(path.branch);
  for (const PathSegment& segment : path.segments) {
    text += fmt::format(" {} {}", to_string(segment.mode), to_string(segment.extent_kind));
    if (segment.extent_kind != ExtentKind::target_nu) text += fmt::format(" {}", segment.extent);
  }
  return text;
}

std::map<std::string, std::set<double>> densities_of(const Dataset& dataset) {
  std::map<std::string, std::set<double>> densities;
  for (const DatasetTest& test : dataset.tests)
    densities[path_without_density(test.record.path)].insert(test.record.path.nu);
  return densities;
}

void keep_densities(Dataset& dataset, std::size_t every) {
  const auto densities = densities_of(dataset);
  std::erase_if(dataset.tests, [&](const DatasetTest& test) {
    const std::set<double>& all = densities.at(path_without_density(test.record.path));
    return static_cast<std::size_t>(std::distance(all.begin(), all.find(test.record.path.nu))) % every != 0;
  });
}

void shorten_shear(DatasetTest& test, double fraction) {
  if (!is_pure_shear(test.record)) return;
  PathSegment& segment = test.record.path.segments.front();
  segment.extent *= fraction;
  const double start = test.record.rows.front().shear_path;
  std::erase_if(test.record.rows,
                [&](const Observation& row) { return row.shear_path - start > segment.extent + kChoiceRounding; });
  test.cost.steps = static_cast<std::uint64_t>(std::llround(fraction * static_cast<double>(test.cost.steps)));
  test.cost.seconds *= fraction;
}

[[noreturn]] void refuse(const std::string& key, const Json& value, const std::string& remedy) {
  throw InvalidInput(
      fmt::format("{}={}: {}", key, value.is_string() ? value.get<std::string>() : value.dump(), remedy));
}

std::size_t count_of(const std::string& key, const Json& value, std::size_t most) {
  const double number = value.is_number() ? value.get<double>() : 0;
  if (!(number >= 2 && number <= static_cast<double>(most)) || number != std::floor(number))
    refuse(key, value, most < 2 ? "the data set has no second one" : fmt::format("give a number from 2 to {}", most));
  return static_cast<std::size_t>(number);
}

void apply(const std::string& key, const Json& value, FitChoice& choice) {
  Dataset& dataset = choice.dataset;
  if (key == "rows_every") {
    const std::size_t every = count_of(key, value, 1000);
    for (DatasetTest& test : dataset.tests) keep_rows(test.record.rows, every);
  } else if (key == "packings") {
    keep_packings(dataset, count_of(key, value, packings_of(dataset).size()));
  } else if (key == "densities_every") {
    keep_densities(dataset, count_of(key, value, 1000));
  } else if (key == "shear_strain") {
    const double fraction = value.is_number() ? value.get<double>() : 0;
    if (!(fraction > 0 && fraction < 1)) refuse(key, value, "give a fraction between 0 and 1");
    for (DatasetTest& test : dataset.tests) shorten_shear(test, fraction);
  } else if (key == "loss") {
    if (value != "huber") refuse(key, value, "give huber");
    choice.options.loss = fit::Loss::huber;
  } else {
    refuse(key, value, "is no choice of a fit; give rows_every, packings, densities_every, shear_strain or loss");
  }
}

}  // namespace

FitChoice chosen(const FitChoice& everything, const Changes& changes) {
  FitChoice choice = everything;
  for (const auto& [key, value] : changes) apply(key, value, choice);
  return choice;
}

std::vector<std::string> usual_choices(const Dataset& dataset) {
  std::vector<std::string> choices{"rows_every=2", "rows_every=4", "rows_every=8"};
  std::size_t packings = packings_of(dataset).size();
  while (packings > 2) {
    packings = (packings + 1) / 2;
    choices.push_back(fmt::format("packings={}", packings));
  }
  const auto densities = densities_of(dataset);
  if (std::any_of(densities.begin(), densities.end(), [](const auto& path) { return path.second.size() > 2; }))
    choices.push_back("densities_every=2");
  for (const char* choice : {"shear_strain=0.75", "shear_strain=0.5", "loss=huber"}) choices.push_back(choice);
  return choices;
}

}  // namespace grainlaw::chain
