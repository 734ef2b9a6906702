#pragma once
// Runs dealt out to tasks, which a site's scheduler starts anywhere: FOLDER/tasks/ holds spec.json, what the runs are planned by, and
// tasks.json, which says who makes what. Tasks share the store FOLDER/runs with each other and with every calibration.

#include <filesystem>
#include <string>
#include <vector>

#include "dem/runs/run_list.hpp"
#include "dem/runs/spec_file.hpp"

namespace grainlaw::dem {

inline constexpr const char* kTasksFolder = "tasks";

struct ListedRun {
  int task = 0;               ///< that makes it, from 1; 0: none
  std::string name;           ///< as in PlannedRun
  std::string key;            ///< in the store
  std::string preparation;    ///< key of the run that it starts from; empty: from none
  double particle_steps = 0;  ///< expected, relaxations by their force passes
};
constexpr auto fields_of(std::type_identity<ListedRun>) {
  using R = ListedRun;
  return std::tuple{Field{&R::task, "task", "", "", "that makes it, from 1; 0: none"},
                    Field{&R::name, "name", "", "", "of the test, or preparation-sSEED"},
                    Field{&R::key, "key", "", "", "its folder in runs/"},
                    Field{&R::preparation, "preparation", "", "", "key of the run that it starts from; empty: none"},
                    Field{&R::particle_steps, "particle_steps", "", "", "expected work"}};
}
static_assert(tells_every_member<ListedRun>());

/// Longest first.
std::vector<ListedRun> listed(const std::vector<PlannedRun>& runs);

/// Sets the tasks, at most as many as runs, so that each has about the same to do: preparations first, then each run to the task that
/// makes its preparation while that has less than its share, else to the one with the least. Sorts by task; preparations come
/// first in each.
void deal(std::vector<ListedRun>& runs, int tasks);

struct TaskList {
  Spec spec;
  std::vector<ListedRun> runs;  ///< as they were dealt out
};

/// Deals the runs of `spec` that are not finished in `output`/runs out to tasks and writes `output`/tasks. Throws Error, InvalidInput
/// for what is no folder.
TaskList write_tasks(const Spec& spec, int tasks, const std::filesystem::path& output, const Execution& execution);

/// Throws InvalidInput that names the command which writes it.
TaskList read_tasks(const std::filesystem::path& output);

/// Makes runs of `list` in `output`/runs unless they are finished; those that a living other makes come last and are waited for.
/// `which`: numbers of tasks, names of runs, keys or their first eight digits or more. Throws InvalidInput for what is none of
/// these.
RunCounts make_tasks(const TaskList& list, const std::vector<std::string>& which, const std::filesystem::path& output,
                     const Execution& execution);

}  // namespace grainlaw::dem
