#include "dem/lammps/lammps_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dem/element_tests/energy_watch.hpp"
#include "dem/engine/run_watch.hpp"
#include "dem/export/snapshot.hpp"
#include "dem/lammps/frame_row.hpp"
#include "model/files/output.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;
constexpr double kSameCell = 1e-10;  // relative

/// A segment as LAMMPS takes it.
struct Leg {
  Drive drive;
  std::uint64_t steps = 0, begin = 0;  ///< of it; LAMMPS's counter at its start
  double time = 0, sheared = 0;        ///< before it [s], [-]

  double e(std::uint64_t step) const { return step == steps ? drive.segment.length : path_parameter(drive, t(step)); }
  double t(std::uint64_t step) const { return drive.duration * static_cast<double>(step) / static_cast<double>(steps); }
  /// The first step, at least 1, that reaches this place.
  std::uint64_t reaches(double place) const {
    std::uint64_t low = 1, high = steps;
    while (low < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      if (e(middle) >= place)
        high = middle;
      else
        low = middle + 1;
    }
    return high;
  }
};

/// Where LAMMPS stops on its way: a row, or a further restart file.
struct Halt {
  std::size_t leg = 0;
  std::uint64_t step = 0;  ///< of it
  bool row = false;
  std::string keep;
};

class LammpsRun {
 public:
  LammpsRun(const LammpsPlace& place, const LammpsTest& test, const State& start, const RunControl& control,
            const Checkpointing& checkpointing)
      : place_(place),
        test_(test),
        start_(start),
        control_(control),
        checkpointing_(checkpointing),
        spheres_(deck_spheres(start, test.contacts)),
        N_(shear_direction(test.segments)) {}

  void take_up(Checkpoint from) {
    if (from.segment < 0 || static_cast<std::size_t>(from.segment) >= test_.segments.size() || from.rows.empty())
      throw InvalidInput("the checkpoint is not one of this test; start it anew");
    plan(from.segment_H, static_cast<std::size_t>(from.segment));
    const auto at = std::find_if(halts_.begin(), halts_.end(), [&](const Halt& halt) {
      return halt.row && halt.leg == static_cast<std::size_t>(from.segment) && halt.step == from.segment_steps;
    });
    if (at == halts_.end()) throw InvalidInput("the checkpoint is not one of this test; start it anew");
    at_ = std::move(from);
    done_ = static_cast<std::size_t>(at - halts_.begin()) + 1;
    last_ = look_name(at_.steps);
    saved_names_ = {last_};
    for (const Observation& row : at_.rows) note(row);
    warnings_.push_back(fmt::format(
        "went on from LAMMPS's restart file at step {}: its last digits need not be those of a run without a break",
        at_.steps));
    if (place_.log) place_.log(warnings_.back());
  }

  void begin() { plan(start_.packing.H, 0); }

  LammpsResult run() {
    const bool anew = done_ == 0;
    if (anew || done_ < halts_.size()) {
      try {
        run_deck(place_, test_.name, deck(), control_, [&](const std::string& look) { take(look); });
      } catch (const Error&) {
        save_what_there_is();
        throw;
      }
      if (done_ != halts_.size()) throw Error("LAMMPS has ended before the end of the test without saying why");
    }
    LammpsResult result;
    if (!test_.flow) rate_.report(warnings_, "inertial number", test_.options.warn_inertial_number, at_.rows.size());
    if (!halts_.empty()) result.restart = look_name(at_.steps) + ".restart";
    result.test.steps = at_.steps;
    result.test.time_step = at_.time_step;
    result.test.seconds = at_.seconds + seconds_since(began_);
    result.test.warnings = warnings_;
    result.test.rows = std::move(at_.rows);
    result.test.end = std::move(at_.state);
    return result;
  }

 private:
  std::string look_name(std::uint64_t steps) const { return fmt::format("{}-{}", test_.name, steps); }
  std::uint64_t steps_at(const Halt& halt) const { return legs_[halt.leg].begin + halt.step; }

  /// Legs and halts of the path; `H` is the cell at the start of segment `known`. Of those before it only the lengths count.
  void plan(const Eigen::Matrix3d& H, std::size_t known) {
    const double dt = test_.options.engine.time_step_fraction * min_collision_time(start_.packing, start_.material);
    std::uint64_t begin = 0;
    double time = 0, sheared = 0;
    Eigen::Matrix3d H_0 = H;
    for (std::size_t k = 0; k < test_.segments.size(); ++k) {
      const StraightSegment& segment = test_.segments[k];
      if (k == known) H_0 = H;
      const Drive drive = make_drive(segment, test_.options.drive, H_0);
      const double steps = std::max(1.0, std::ceil(drive.duration / dt * (1 - 1e-12)));
      if (!(steps <= 2e9))
        throw InvalidInput("strain_rate: a segment would take more than 2e9 steps; give a larger one");
      legs_.push_back({drive, static_cast<std::uint64_t>(steps), begin, time, sheared});
      add_halts(k);
      begin += legs_[k].steps;
      time += drive.duration;
      sheared += shear_length(segment);
      H_0 = stretch_of(segment, segment.length).asDiagonal() * H_0;
      total_ = begin;
    }
  }

  void add_halts(std::size_t k) {
    const Leg& leg = legs_[k];
    std::vector<Halt> all;
    for (int row = 1; row <= test_.options.rows; ++row) {
      const std::uint64_t step =
          row == test_.options.rows ? leg.steps : leg.reaches(leg.drive.segment.length * row / test_.options.rows);
      if (all.empty() || all.back().step != step) all.push_back({k, step, true, ""});
    }
    for (const Keep& keep : k == 0 ? test_.keep : std::vector<Keep>{})
      all.push_back({k, leg.reaches(std::min(keep.e, leg.drive.segment.length)), false, keep.file});
    std::stable_sort(all.begin(), all.end(), [](const Halt& a, const Halt& b) {
      return std::pair(a.step, a.row) < std::pair(b.step, b.row);  // what is kept is there before its row
    });
    halts_.insert(halts_.end(), all.begin(), all.end());
  }

  /// From the start, or from the last row on.
  std::string deck() {
    std::string text;
    std::uint64_t at = at_.steps;
    if (done_ > 0) {
      text = deck_of_restart(look_name(at) + ".restart", false, spheres_);
    } else {
      const std::string data = test_.name + ".data";
      if (test_.restart.empty()) write_data(place_, data, start_);
      text = test_.restart.empty() ? deck_of_data(data, spheres_) : deck_of_restart(test_.restart, true, spheres_);
      text += deck_look(look_name(0));
    }
    for (std::size_t k = 0; k < legs_.size(); ++k) {
      const Leg& leg = legs_[k];
      if (at >= leg.begin + leg.steps) continue;
      const std::string cell = fmt::format("{}_{}_{}", test_.name, k, at);
      text += deck_drive(cell, leg.drive, leg.steps, leg.begin);
      const std::uint64_t fixed = at;
      for (std::size_t h = done_; h < halts_.size(); ++h) {
        if (halts_[h].leg != k) continue;
        const std::uint64_t to = steps_at(halts_[h]);
        if (to > at) text += deck_run(at, to, fixed, leg.begin + leg.steps);
        at = to;
        text += halts_[h].row ? deck_look(look_name(to)) : deck_keep(halts_[h].keep);
      }
      text += deck_end_of_drive(cell);
    }
    return text;
  }

  void take(const std::string& mark) {
    const std::string look = mark.substr(0, mark.find(' '));
    if (look == look_name(0)) return see(mark, {});
    const Halt& halt = halts_.at(done_);
    if (look != (halt.row ? look_name(steps_at(halt)) : halt.keep)) throw Error("LAMMPS's marks are out of order");
    if (halt.row) {
      const Leg& leg = legs_[halt.leg];
      see(mark, halt);
      at_.segment = static_cast<int>(halt.leg);
      at_.segment_H = leg.drive.H_0;
      at_.segment_steps = halt.step;
      at_.steps = at_.state.step;
      at_.time_step = std::max(at_.time_step, leg.drive.duration / static_cast<double>(leg.steps));
      forget(look);
    }
    ++done_;
    if (control_.report) {
      const double steps = static_cast<double>(steps_at(halt));
      control_.report({"LAMMPS", steps / static_cast<double>(total_),
                       steps * static_cast<double>(start_.packing.size()), "particle-steps"});
    }
  }

  /// A row at the place of `halt`, whose mark this is.
  void see(const std::string& mark, const Halt& halt) {
    const Leg* leg = legs_.empty() ? nullptr : &legs_[halt.leg];
    const StraightSegment segment = leg ? leg->drive.segment : StraightSegment{};
    const double e = leg ? leg->e(halt.step) : 0, t = leg ? leg->t(halt.step) : 0;
    Eigen::Matrix3d L = Eigen::Matrix3d::Zero();
    if (leg) L = path_parameter_rate(leg->drive, t) * segment.direction.tensor;
    Look look = read_look(place_.folder, mark, start_, spheres_, L, N_);
    const Eigen::Matrix3d H = leg ? stretch_of(segment, e).asDiagonal() * leg->drive.H_0 : start_.packing.H;
    if (!((look.state.packing.H - H).norm() <= kSameCell * H.norm()))
      throw Error(fmt::format("{}: LAMMPS's cell is not where the path leads; give a version that is known: {}", mark,
                              kKnownLammps));
    look.row.time = leg ? leg->time + t : 0;
    fill_path(look.row, segment, static_cast<int>(halt.leg), e, leg ? leg->sheared : 0);
    look.state.step = leg ? leg->begin + halt.step : 0;
    look.state.time = look.row.time;
    note(look.row);
    at_.rows.push_back(look.row);
    at_.state = std::move(look.state);
  }

  void note(const Observation& row) {
    if (row.C_star >= (test_.contacts.friction > 0 ? 4 : 6))
      rate_.note(row.inertial_number, test_.options.warn_inertial_number, row.nu);
  }

  /// Saves when it is time, and removes restart files that no checkpoint needs any more.
  void forget(const std::string& look) {
    if (!last_.empty() && std::find(saved_names_.begin(), saved_names_.end(), last_) == saved_names_.end())
      fs::remove(place_.folder / (last_ + ".restart"));
    last_ = look;
    if (seconds_since(saved_) >= checkpointing_.interval) save();
  }

  /// After a failure, whose message is not to be lost.
  void save_what_there_is() {
    try {
      if (at_.segment_steps > 0) save();
    } catch (const Error& why) {
      if (place_.log) place_.log(fmt::format("no checkpoint: {}", why.what()));
    }
  }

  void save() {
    if (!checkpointing_.save) return;
    Checkpoint checkpoint = at_;
    checkpoint.seconds += seconds_since(began_);
    checkpointing_.save(checkpoint);
    saved_ = Clock::now();
    saved_names_.push_back(last_);
    if (saved_names_.size() > 2) {  // the last one and the one before it
      if (saved_names_.front() != last_) fs::remove(place_.folder / (saved_names_.front() + ".restart"));
      saved_names_.erase(saved_names_.begin());
    }
  }

  const LammpsPlace& place_;
  const LammpsTest& test_;
  const State& start_;
  const RunControl& control_;
  const Checkpointing& checkpointing_;
  DeckSpheres spheres_;
  Deviator<double> N_;
  std::vector<Leg> legs_;
  std::vector<Halt> halts_;
  std::size_t done_ = 0;     // halts
  std::uint64_t total_ = 0;  // steps of the path
  Checkpoint at_;            // the last row
  std::string last_;         // look of that row
  std::vector<std::string> saved_names_;
  std::vector<std::string> warnings_;
  Excess rate_;
  Clock::time_point began_ = Clock::now(), saved_ = began_;
};

}  // namespace

DeckSpheres deck_spheres(const State& state, const ContactModel& contacts) {
  return {state.material, contacts, mean_radius(state.packing)};
}

void write_data(const LammpsPlace& place, const std::string& file, const State& state) {
  if (!state.packing.H.isDiagonal(0)) throw InvalidInput("the cell is sheared; LAMMPS is given upright cells only");
  Snapshot snapshot;
  snapshot.packing = state.packing;
  snapshot.density = state.material.density;
  wrap(snapshot.packing);
  std::iota(snapshot.packing.id.begin(), snapshot.packing.id.end(), 0);
  write_durably(place.folder / file, lammps_data(snapshot));
}

LammpsResult run_lammps_test(const LammpsPlace& place, const LammpsTest& test, const State& start,
                             std::optional<Checkpoint> from, const RunControl& control,
                             const Checkpointing& checkpointing) {
  check_can_follow(test.segments);
  LammpsRun run(place, test, start, control, checkpointing);
  if (from)
    run.take_up(std::move(*from));
  else
    run.begin();
  return run.run();
}

std::string restart_of(const Checkpoint& checkpoint) {
  const std::string name =
      checkpoint.stage.empty() ? kTestName : checkpoint.stage.substr(0, checkpoint.stage.find(' '));
  return fmt::format("{}-{}.restart", name, checkpoint.steps);
}

}  // namespace grainlaw::dem
