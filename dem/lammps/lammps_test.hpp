#pragma once
// An element test by LAMMPS: a packing driven along a strain path, seen at the same places as by dem/element_tests, by our
// averages. LAMMPS runs as a child in a folder of scratch files; each row is read, and its files removed, as soon as it is there.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dem/element_tests/element_run.hpp"
#include "dem/lammps/deck.hpp"
#include "dem/lammps/program.hpp"

namespace grainlaw::dem {

/// Where LAMMPS works.
struct LammpsPlace {
  std::filesystem::path folder;  ///< scratch files; it exists
  LammpsProgram program;
  std::function<void(const std::string&)> log;  ///< may be empty
};

/// Runs a deck of this name; `on_look` is told of each look when its files are whole. Throws Interrupted when a stop is
/// requested, and Error with the last lines of LAMMPS's log when it dies; the files of the last looks stay.
void run_deck(const LammpsPlace& place, const std::string& name, const std::string& deck, const RunControl& control,
              const std::function<void(const std::string& look)>& on_look);

/// `spheres` as a data file of LAMMPS in the folder; ids are places from 1 on. Throws InvalidInput for a sheared cell.
void write_data(const LammpsPlace& place, const std::string& file, const State& state);

DeckSpheres deck_spheres(const State& state, const ContactModel& contacts);

/// A further restart file on the way: when the path parameter of the first segment reaches e.
struct Keep {
  double e = 0;
  std::string file;
};

struct LammpsTest {
  std::string name;     ///< letters; of its files, other than those of tests before it in the same folder
  std::string restart;  ///< restart file in the folder to start from; empty: the state alone
  std::vector<StraightSegment> segments;
  ElementTestOptions options;
  ContactModel contacts;
  std::vector<Keep> keep;  ///< in the order of e
  bool flow = false;       ///< not meant to be quasi-static: no warning of inertia
};

struct LammpsResult {
  ElementTest test;
  std::string restart;  ///< of its end; empty without segments
};

inline constexpr const char* kTestName = "test";  ///< of element tests; stages of a preparation begin with theirs

/// The restart file in the folder without which a checkpoint cannot be taken up.
std::string restart_of(const Checkpoint& checkpoint);

/// Runs the test from `start`, or goes on from a checkpoint of it (`start` then has its spheres, wherever they are) and the
/// restart file of that row. A run that went on is not the uninterrupted one to the last digit, and a warning says so.
LammpsResult run_lammps_test(const LammpsPlace& place, const LammpsTest& test, const State& start,
                             std::optional<Checkpoint> from, const RunControl& control,
                             const Checkpointing& checkpointing);

}  // namespace grainlaw::dem
