#include "app/terminal/import_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "app/terminal/help.hpp"
#include "model/files/one_line.hpp"

namespace grainlaw::app {
namespace {

/// What is said of tests, once for those of which the same is said.
class Said {
 public:
  void add(const std::string& test, const std::string& text) {
    auto known = std::ranges::find(all_, text, &std::pair<std::string, std::vector<std::string>>::first);
    if (known == all_.end()) known = all_.insert(all_.end(), {text, {}});
    known->second.push_back(test);
  }
  std::string text() const {
    std::string text;
    for (const auto& [said, tests] : all_) {
      for (const std::string& line : wrapped(fmt::format("{}", fmt::join(tests, ", ")), 80)) text += line + "\n";
      text += said;
    }
    return text;
  }

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> all_;
};

std::string table_of(const chain::ForeignRows& foreign) {
  std::size_t column = 6, unit = 4, sign = 8;
  for (const chain::ColumnUse& use : foreign.columns) {
    column = std::max(column, one_line(use.column, 30).size());
    unit = std::max(unit, use.unit.size());
    sign = std::max(sign, use.sign.size());
  }
  std::string text;
  const auto add = [&](const std::string& c, const std::string& u, const std::string& s, const std::string& meaning) {
    text += fmt::format("  {:<{}}  {:<{}}  {:<{}}  {}\n", c, column, u, unit, s, sign, meaning);
  };
  add("column", "unit", "positive", "taken for");
  for (const chain::ColumnUse& use : foreign.columns)
    add(one_line(use.column, 30), use.unit, use.sign, use.meaning.empty() ? "kept aside" : use.meaning);
  for (const std::string& note : foreign.notes) text += fmt::format("  {}\n", note);
  return text;
}

}  // namespace

std::string columns_text(const std::vector<chain::ForeignTest>& tests) {
  Said said;
  for (const chain::ForeignTest& test : tests) said.add(test.mapping.name, table_of(test.foreign));
  return said.text();
}

std::string paths_text(const std::vector<chain::ImportedTest>& tests) {
  Said said;
  for (const chain::ImportedTest& test : tests) {
    std::string text;
    for (const std::string& line : test.says) text += fmt::format("  {}\n", line);
    said.add(test.record.name, text);
  }
  return said.text();
}

std::string written_text(const Dataset& dataset, const std::filesystem::path& output) {
  return fmt::format(
      "{}: {} tests on {} packings\nnext: grainlaw check {}\n      grainlaw calibrate --dataset {} -o law\n",
      output.string(), dataset.tests.size(), dataset.seeds.size(), output.string(), output.string());
}

OrderedJson import_json(const std::vector<chain::ForeignTest>& foreign, const std::vector<chain::ImportedTest>& tests,
                        const std::string& output) {
  OrderedJson list = OrderedJson::array();
  for (std::size_t i = 0; i < tests.size(); ++i) {
    OrderedJson columns = OrderedJson::array();
    for (const chain::ColumnUse& use : foreign[i].foreign.columns)
      columns.push_back({{"column", use.column},
                         {"meaning", use.meaning.empty() ? OrderedJson(nullptr) : OrderedJson(use.meaning)},
                         {"unit", use.unit},
                         {"positive", use.sign.empty() ? OrderedJson(nullptr) : OrderedJson(use.sign)}});
    list.push_back({{"name", tests[i].record.name},
                    {"rows", tests[i].record.rows.size()},
                    {"columns", columns},
                    {"notes", foreign[i].foreign.notes},
                    {"path", tests[i].says}});
  }
  return {{"output", output.empty() ? OrderedJson(nullptr) : OrderedJson(output)},
          {"tests", list},
          {"warnings", chain::suspicions(tests)}};
}

}  // namespace grainlaw::app
