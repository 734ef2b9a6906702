#include "dem/runs/path_frames.hpp"

#include <fmt/format.h>

#include <algorithm>

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

void PathFrames::write_places() const { write_whole(folder_ / kFramesFile, table_text(places_)); }

StepObserver PathFrames::at_start() {
  return [this](Stepper& stepper, int segment, double e) {
    places_.clear();
    keep(stepper, segment, e);
  };
}

StepObserver PathFrames::observer() {
  return [this](Stepper& stepper, int segment, double e) {
    const double length = segments_[static_cast<std::size_t>(segment)].length;
    const auto passed = [&](double at) {  // of count_ equal parts
      int parts = std::max(0, static_cast<int>(at / length * count_) - 1);
      while (parts < count_ && at >= (parts + 1 == count_ ? length : length * (parts + 1) / count_)) ++parts;
      return parts;
    };
    if (passed(e) > (places_.back().segment == segment ? passed(places_.back().e) : 0)) keep(stepper, segment, e);
  };
}

void PathFrames::keep(Stepper& stepper, int segment, double e) {
  State state = stepper.state();
  state.digest = digest_;
  const Eigen::Vector3d L = stepper.motion().L.diagonal();
  const FramePlace place{static_cast<int>(places_.size()), state.time, segment, e, L[0], L[1], L[2]};
  write_state(folder_ / frame_file(place.frame), state, write_whole);
  places_.push_back(place);
}

}  // namespace grainlaw::dem
