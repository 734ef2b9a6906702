#include "app/report/tables.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "app/report/dem_series.hpp"
#include "app/report/table_cells.hpp"

namespace grainlaw::app::report {
namespace {

/// Largest defined value of `of` over the rows of `test`; NaN when there is none.
template <class Function>
double largest(const TestRecord& test, const Function& of) {
  double result = kUndefined;
  for (const Observation& row : test.rows) {
    const double value = of(row);
    if (std::isfinite(value) && !(value <= result)) result = value;
  }
  return result;
}

}  // namespace

Table run_table(const ReportInput& input) {
  Table table;
  table.caption = "Runs of the data set";
  table.source = "dataset/";
  table.columns = {words(plain("test")),
                   words(plain("role")),
                   words(plain("path")),
                   quantity(notation("{ν} at start")),
                   quantity(plain("seed")),
                   quantity(notation("{N}")),
                   quantity(plain("rows")),
                   quantity(plain("steps")),
                   quantity(plain("seconds")),
                   quantity(notation("median {E}_{kin}/{E}_{pot}")),
                   quantity(plain("largest |energy residual|")),
                   quantity(notation("largest {I}"))};
  for (std::size_t i = 0; i < input.tests.size(); ++i) {
    const TestRecord& test = input.tests[i];
    const RunCost& cost = input.costs[i];
    const bool known = cost.steps > 0;
    std::vector<double> ratios;
    for (const Observation& row : test.rows) {
      const double ratio = row.E_kin / row.E_pot;
      if (std::isfinite(ratio)) ratios.push_back(ratio);
    }
    double median = kUndefined;
    if (!ratios.empty()) {
      const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
      std::nth_element(ratios.begin(), middle, ratios.end());
      median = *middle;
    }
    table.rows.push_back(
        {plain(test.name), plain(to_string(test.role)), plain(kind_of(test.path)), plain(fixed(test.path.nu, 3)),
         plain(std::to_string(test.packing.seed)), plain(std::to_string(test.packing.particles)),
         plain(std::to_string(test.rows.size())), plain(known ? std::to_string(cost.steps) : kNoNumber),
         plain(known ? significant(cost.seconds, 3) : kNoNumber), number(median, 2),
         number(largest(test, [](const Observation& row) { return std::abs(row.energy_residual); }), 2),
         number(largest(test, [](const Observation& row) { return row.inertial_number; }), 2)});
  }
  return table;
}

Table cost_table(const ReportInput& input) {
  Table table;
  table.caption = "What the DEM runs cost";
  table.columns = {words(plain("files")), quantity(plain("tests")), quantity(plain("time steps")),
                   quantity(plain("particle-steps")), quantity(plain("seconds, all runs together"))};
  const auto add = [&](const std::string& files, std::size_t count, const auto& test_of, const auto& cost_of) {
    double steps = 0, work = 0, seconds = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const RunCost& cost = cost_of(i);
      steps += static_cast<double>(cost.steps);
      work += static_cast<double>(cost.steps) * static_cast<double>(test_of(i).packing.particles);
      seconds += cost.seconds;
    }
    table.rows.push_back({plain(files), plain(std::to_string(count)), number(steps), number(work), number(seconds)});
  };
  add(
      "dataset/", input.tests.size(), [&](std::size_t i) -> const TestRecord& { return input.tests[i]; },
      [&](std::size_t i) -> const RunCost& { return input.costs[i]; });
  for (const predict::PredictionFolder& prediction : input.predictions) {
    if (!prediction.dem) continue;
    const auto& tests = prediction.dem->tests;
    add(
        "predictions/" + prediction.name + "/dem/", tests.size(),
        [&](std::size_t i) -> const TestRecord& { return tests[i].record; },
        [&](std::size_t i) -> const RunCost& { return tests[i].cost; });
  }
  return table;
}

Table provenance_table(const ReportInput& input) {
  Table table;
  table.caption = "Where this comes from";
  table.columns = {words(plain("what")), words(plain("value")), words(plain("said by"))};
  std::set<std::string> all;
  for (const Fact& fact : input.provenance) all.insert(fact.files.begin(), fact.files.end());
  for (const Fact& fact : input.provenance) {
    std::string files;
    for (const std::string& file : fact.files) files += (files.empty() ? "" : ", ") + file;
    if (fact.files.size() == all.size() && all.size() > 1) files = "all files";
    table.rows.push_back({plain(fact.what), plain(fact.value), plain(files)});
  }
  return table;
}

Table spec_table(const ReportInput& input) {
  Table table;
  table.caption = "The spec with every default resolved";
  table.source = "dataset/dataset.json";
  table.columns = {words(plain("key")), words(plain("value"))};
  for (const Fact& fact : input.spec) table.rows.push_back({plain(fact.what), plain(fact.value)});
  return table;
}

}  // namespace grainlaw::app::report
