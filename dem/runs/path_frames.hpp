#pragma once
// States on the way of an element test, at equal steps of the path: frame-0000.state at its start, then, in each segment, at
// the first step that reaches e = length k/N. frames.csv says where each is. The run is the same with and without. States are
// written whole but synced only when the run ends; one that the machine's death has damaged makes an interrupted run start anew.
// frames.csv is written with each checkpoint and at the end: what was kept after a checkpoint is kept again, with the same bits.

#include <filesystem>
#include <string>
#include <vector>

#include "dem/element_tests/element_run.hpp"

namespace grainlaw::dem {

inline constexpr const char* kFramesFile = "frames.csv";

/// One line of frames.csv.
struct FramePlace {
  int frame = 0;                        ///< number in the file's name
  double time = 0;                      ///< since the start of the test [s]
  int segment = 0;                      ///< index of the path's segment
  double e = 0;                         ///< path parameter in it [-]
  double L_xx = 0, L_yy = 0, L_zz = 0;  ///< velocity gradient of the cell, of which viscous forces know [1/s]
};
constexpr auto fields_of(std::type_identity<FramePlace>) {
  using F = FramePlace;
  return std::tuple{
      Field{&F::frame, "frame"},      Field{&F::time, "time", "s"},   Field{&F::segment, "segment"}, Field{&F::e, "e"},
      Field{&F::L_xx, "L_xx", "1/s"}, Field{&F::L_yy, "L_yy", "1/s"}, Field{&F::L_zz, "L_zz", "1/s"}};
}
static_assert(tells_every_member<FramePlace>());

/// "frame-0012.state"
std::string frame_file(int frame);

/// The frames of a folder in their order; none without frames.csv. Throws InvalidInput when that is damaged.
std::vector<FramePlace> read_frame_places(const std::filesystem::path& folder);

class PathFrames {
 public:
  /// N = `count` frames in each segment; `segments` must outlive them. `digest` is written into the states.
  PathFrames(std::filesystem::path folder, int count, const std::vector<StraightSegment>& segments, std::string digest);

  /// Takes up what an earlier session left with its last checkpoint; false when that is damaged.
  bool take_up();

  /// frames.csv.
  void write_places() const;

  /// For the start of the run, and for its steps; must not outlive the frames.
  StepObserver at_start();
  StepObserver observer();

 private:
  void keep(Stepper& stepper, int segment, double e);

  std::filesystem::path folder_;
  int count_;
  const std::vector<StraightSegment>& segments_;
  std::string digest_;
  std::vector<FramePlace> places_;
};

}  // namespace grainlaw::dem
