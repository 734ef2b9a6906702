// The DEM runs: how exact they were, what they cost, where everything comes from.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "app/report/series.hpp"
#include "app/report/tables.hpp"

namespace grainlaw::app::report {
namespace {

using enum Content;

/// Defined values of `of` over the rows of `test`.
template <class Function>
std::vector<double> values(const TestRecord& test, const Function& of) {
  std::vector<double> defined;
  for (const Observation& row : test.rows) {
    if (const double value = of(row); std::isfinite(value)) defined.push_back(value);
  }
  return defined;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? kUndefined : *std::max_element(values.begin(), values.end());
}

/// The upper one of the two in the middle.
double median(std::vector<double> values) {
  if (values.empty()) return kUndefined;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Run {
  const TestRecord& test;
  const RunCost& cost;
};

/// Of steps and seconds: data of others tell none, preparations no steps.
Cell if_known(double number, int digits_shown = 4) {
  return number > 0 ? Cell(digits(number, digits_shown)) : Cell(kNoNumber);
}

std::vector<Run> runs_of(const chain::ReportInput& input) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < input.tests.size(); ++i) runs.push_back({input.tests[i], input.costs[i]});
  return runs;
}

/// The runs of one data set together.
struct RunSum {
  std::string files;
  std::size_t tests = 0;
  double steps = 0, particle_steps = 0, seconds = 0;
};

RunSum sum_of(const std::string& files, const std::vector<Run>& runs) {
  RunSum sum{files, runs.size()};
  for (const Run& run : runs) {
    const double steps = static_cast<double>(run.cost.steps);
    sum.steps += steps;
    sum.particle_steps += steps * static_cast<double>(run.test.packing.particles);
    sum.seconds += run.cost.seconds;
  }
  return sum;
}

}  // namespace

Table run_table(const chain::ReportInput& input) {
  const auto energy_ratio = [](const Observation& row) { return row.E_kin / row.E_pot; };
  const auto energy_error = [](const Observation& row) { return std::abs(row.energy_residual); };
  const auto inertial_number = [](const Observation& row) { return row.inertial_number; };
  return table_of(
      "Runs of the data set", "dataset/", runs_of(input),
      {{"test", words, [](auto& run) { return run.test.name; }},
       {"role", words, [](auto& run) { return to_string(run.test.role); }},
       {"path", words, [](auto& run) { return kind_of(run.test.path); }},
       {"{ν} at start", number, [](auto& run) { return decimals(run.test.path.nu, 3); }},
       {"seed", number, [](auto& run) { return run.test.packing.seed; }},
       {"{N}", number, [](auto& run) { return run.test.packing.particles; }},
       {"rows", number, [](auto& run) { return run.test.rows.size(); }},
       {"steps", number, [](auto& run) { return run.cost.steps > 0 ? Cell(run.cost.steps) : Cell(kNoNumber); }},
       {"seconds", number, [](auto& run) { return if_known(run.cost.seconds, 3); }},
       {"median {E}_{kin}/{E}_{pot}", number,
        [=](auto& run) { return digits(median(values(run.test, energy_ratio)), 2); }},
       {"largest |energy residual|", number,
        [=](auto& run) { return digits(largest(values(run.test, energy_error)), 2); }},
       {"largest {I}", number, [=](auto& run) { return digits(largest(values(run.test, inertial_number)), 2); }}});
}

Table cost_table(const chain::ReportInput& input) {
  std::vector<RunSum> sums{sum_of("dataset/", runs_of(input))};
  for (const predict::PredictionFolder& prediction : input.predictions) {
    if (!prediction.dem) continue;
    std::vector<Run> runs;
    for (const DatasetTest& test : prediction.dem->tests) runs.push_back({test.record, test.cost});
    sums.push_back(sum_of("predictions/" + prediction.name + "/dem/", runs));
  }
  return table_of("What the DEM runs cost", "", sums,
                  {{"files", words, &RunSum::files},
                   {"tests", number, &RunSum::tests},
                   {"time steps of the element tests", number, [](auto& sum) { return if_known(sum.steps); }},
                   {"particle-steps of these", number, [](auto& sum) { return if_known(sum.particle_steps); }},
                   {"seconds, preparations and tests", number, [](auto& sum) { return if_known(sum.seconds); }}});
}

Table provenance_table(const chain::ReportInput& input) {
  std::set<std::string> all;
  for (const chain::Fact& fact : input.provenance) all.insert(fact.files.begin(), fact.files.end());
  const auto said_by = [&](const chain::Fact& fact) {
    if (fact.files.size() == all.size() && all.size() > 1) return std::string("all files");
    std::string files;
    for (const std::string& file : fact.files) files += (files.empty() ? "" : ", ") + file;
    return files;
  };
  return table_of(
      "Where this comes from", "", input.provenance,
      {{"what", words, &chain::Fact::what}, {"value", words, &chain::Fact::value}, {"said by", words, said_by}});
}

Table spec_table(const chain::ReportInput& input) {
  return table_of("The spec with every default resolved", "dataset/dataset.json", input.spec,
                  {{"key", words, &chain::Fact::what}, {"value", words, &chain::Fact::value}});
}

}  // namespace grainlaw::app::report
