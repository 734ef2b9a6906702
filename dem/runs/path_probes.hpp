#pragma once
// Small-strain probes on the way of an element test: at the start, whenever the path has grown by `every`, on copies of
// the state, so that the run is the same with and without. Rows survive an interruption in the run's progress.json.

#include <filesystem>
#include <string>
#include <vector>

#include "dem/element_tests/element_run.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw::dem {

/// The key `probes` of TEST and of a test of SPEC: where along a test its packing is probed.
struct ProbeRequest {
  double every = 0;                 ///< path length between two probes, integral of max(|d eps_vol|, |d eps_dev|) [-]
  std::vector<double> steps{1e-6};  ///< h of the finite steps [-]
};
constexpr auto fields_of(std::type_identity<ProbeRequest>) {
  return std::tuple{Field{&ProbeRequest::every, "every"}, Field{&ProbeRequest::steps, "step"}};
}
static_assert(tells_every_member<ProbeRequest>());

class PathProbes {
 public:
  /// `segments` must outlive the probes.
  PathProbes(std::filesystem::path folder, ProbeRequest request, const std::vector<StraightSegment>& segments,
             int threads, const RunControl& control);

  /// Takes up what an earlier session left in progress.json; false when that is damaged.
  bool take_up();

  /// For the run; must not outlive the probes.
  StepObserver observer();

  /// Writes probes.csv. A test without segments is probed here, at its only state.
  void finish(const State& end);

  /// Probes that did not come to rest or have no positive stiffness.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void probe(const State& state, int segment, double e);
  double length_before(std::size_t segment) const;
  void save() const;

  std::filesystem::path folder_;
  ProbeRequest request_;
  const std::vector<StraightSegment>& segments_;
  int threads_;
  RunControl control_;
  std::size_t done_ = 0;            // places probed
  std::vector<std::string> lines_;  // of probes.csv
  std::vector<std::string> warnings_;
};

}  // namespace grainlaw::dem
