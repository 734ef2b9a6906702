#include "app/terminal/run_list_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "model/files/fields_json.hpp"

namespace grainlaw::app {
namespace {

constexpr std::size_t kShownDigits = 12;  // of a key

double work_of(const std::vector<dem::ListedRun>& runs) {
  double work = 0;
  for (const dem::ListedRun& run : runs) work += run.particle_steps;
  return work;
}

std::vector<double> loads_of(const std::vector<dem::ListedRun>& runs) {
  std::vector<double> loads;
  for (const dem::ListedRun& run : runs) {
    const auto task = static_cast<std::size_t>(run.task);
    loads.resize(std::max(loads.size(), task));
    if (task > 0) loads[task - 1] += run.particle_steps;
  }
  return loads;
}

}  // namespace

RunListing listing_of(const std::vector<dem::ListedRun>& runs, const std::filesystem::path& output) {
  RunListing listing;
  for (const dem::ListedRun& run : runs) {
    const bool finished = dem::is_finished(output / "runs", run.key);
    (finished ? listing.finished : listing.missing).push_back(run);
    if (!finished && dem::maker_of(output / "runs", run.key)) listing.made.push_back(run.key);
  }
  return listing;
}

std::string text_of(const RunListing& listing, const std::filesystem::path& output) {
  const std::set<std::string> made(listing.made.begin(), listing.made.end());
  std::string text = fmt::format("{} runs, {} finished, {} being made, {} missing: {:.3g} particle-steps\n",
                                 listing.finished.size() + listing.missing.size(), listing.finished.size(), made.size(),
                                 listing.missing.size() - made.size(), work_of(listing.missing));
  const std::vector<double> loads = loads_of(listing.missing);
  if (!listing.missing.empty())
    text += fmt::format("  {:>14} {:>6} {:<7} {:<12} {}\n", "particle-steps", loads.empty() ? "" : "task", "", "key",
                        "name");
  for (const dem::ListedRun& run : listing.missing) {
    text +=
        fmt::format("  {:14.3g} {:>6} {:<7} {} {}\n", run.particle_steps, loads.empty() ? "" : std::to_string(run.task),
                    made.contains(run.key) ? "made" : "missing", run.key.substr(0, kShownDigits), run.name);
  }
  if (loads.empty()) return text;
  const auto [least, most] = std::minmax_element(loads.begin(), loads.end());
  return text + fmt::format("{} tasks of {:.3g} to {:.3g} particle-steps: grainlaw task {} K, K = 1 to {}\nin {}\n",
                            loads.size(), *least, *most, output.string(), loads.size(),
                            (output / dem::kTasksFolder / "tasks.json").string());
}

OrderedJson to_json(const RunListing& listing) {
  const std::set<std::string> made(listing.made.begin(), listing.made.end());
  OrderedJson document{{"runs", listing.finished.size() + listing.missing.size()},
                       {"runs_found", listing.finished.size()},
                       {"runs_being_made", made.size()},
                       {"tasks", loads_of(listing.missing).size()},
                       {"particle_steps", work_of(listing.missing)}};
  OrderedJson& list = document["list"] = OrderedJson::array();
  for (const auto* part : {&listing.missing, &listing.finished}) {
    for (const dem::ListedRun& run : *part) {
      list.push_back(fields_to_json(run));
      list.back()["state"] = part == &listing.finished ? "finished" : made.contains(run.key) ? "made" : "missing";
    }
  }
  return document;
}

}  // namespace grainlaw::app
