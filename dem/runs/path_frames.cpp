#include "dem/runs/path_frames.hpp"

#include <fmt/format.h>

#include "dem/element_tests/stepper.hpp"
#include "dem/files/state_file.hpp"
#include "model/files/column.hpp"
#include "model/files/output.hpp"

namespace grainlaw::dem {

std::string frame_file(int frame) { return fmt::format("frame-{:04}.state", frame); }

std::vector<FramePlace> read_frame_places(const std::filesystem::path& folder) {
  std::vector<FramePlace> places;
  if (!std::filesystem::exists(folder / kFramesFile)) return places;
  CsvReader reader(folder / kFramesFile);
  const auto columns = matched<FramePlace>(reader);
  for (std::vector<double> values; reader.next(values);) {
    FramePlace place;
    for (std::size_t c = 0; c < columns.size(); ++c) set_value(reader, place, *columns[c], values[c]);
    if (place.frame != static_cast<int>(places.size())) reader.refuse("frame", "must count from 0; repeat the run");
    places.push_back(place);
  }
  return places;
}

PathFrames::PathFrames(std::filesystem::path folder, int count, const std::vector<StraightSegment>& segments,
                       std::string digest)
    : folder_(std::move(folder)), count_(count), segments_(segments), digest_(std::move(digest)) {}

bool PathFrames::take_up() {
  try {
    places_ = read_frame_places(folder_);
    for (const FramePlace& place : places_) read_state(folder_ / frame_file(place.frame));
    return !places_.empty();
  } catch (const InvalidInput&) {
    places_.clear();
    return false;
  }
}

void PathFrames::keep_start(const State& state, const DriveOptions& drive) {
  places_.clear();
  State start = state;
  start.time = 0;
  start.step = 0;
  Eigen::Vector3d L = Eigen::Vector3d::Zero();
  if (!segments_.empty() && drive.quasi_static_step == 0)
    L = motion_at(make_drive(segments_[0], drive, state.packing.H), 0).L.diagonal();
  keep(std::move(start), {0, 0, 0, 0, L[0], L[1], L[2]});
}

StepObserver PathFrames::observer() {
  return [this](Stepper& stepper, int segment, double e) {
    const double length = segments_[static_cast<std::size_t>(segment)].length;
    const int k = static_cast<int>(places_.size()) - segment * count_;  // of the segment, the next one
    if (k > count_ || e < (k == count_ ? length : length * k / count_)) return;
    const Eigen::Vector3d L = stepper.motion().L.diagonal();
    const State& state = stepper.state();
    keep(state, {static_cast<int>(places_.size()), state.time, segment, e, L[0], L[1], L[2]});
  };
}

void PathFrames::keep(State state, const FramePlace& place) {
  state.digest = digest_;
  write_state(folder_ / frame_file(place.frame), state);
  places_.push_back(place);
  write_durably(folder_ / kFramesFile, table_text(places_));
}

}  // namespace grainlaw::dem
