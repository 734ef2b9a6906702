#include "predict/studies/strain_batch.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "model/vocabulary/error.hpp"
#include "predict/path_integration.hpp"
#include "predict/predict.hpp"
#include "predict/studies/in_ranges.hpp"
#include "predict/studies/walker.hpp"

namespace grainlaw::predict {
namespace {

// Above this share of P no principal stress is near zero; a step that ends below is looked at closely.
constexpr double kClearOfTension = 0.1;
// Of a segment, beyond which something vanishes there and who knows events goes on.
constexpr long kMostSteps = 10'000;

Eigen::Matrix3d tensor_from(const double* components) {
  Eigen::Matrix3d tensor;
  for (std::size_t c = 0; c < kComponentIndex.size(); ++c) {
    const auto [i, j] = kComponentIndex[c];
    tensor(i, j) = tensor(j, i) = components[c];
  }
  return tensor;
}

/// One history: a segment for each step that strains.
struct History {
  std::vector<StraightSegment> segments;
  std::vector<std::size_t> steps;  ///< of the segments

  void read(const StrainBatch& batch, std::size_t path) {
    segments.clear();
    steps.clear();
    Eigen::Matrix3d before = Eigen::Matrix3d::Zero();
    check(path, 0, batch.nu[path]);
    for (std::size_t step = 0; step < batch.steps; ++step) {
      const Eigen::Matrix3d strain = tensor_from(batch.strain + 6 * (path * batch.steps + step));
      const double length = (strain - before).norm(), nu = batch.nu[path] * std::exp(-before.trace());
      check(path, step, batch.nu[path] * std::exp(-strain.trace()));
      if (length > 0) {
        segments.push_back({Mode::tensor, {(strain - before) / length}, length, nu, {before}});
        steps.push_back(step);
      }
      before = strain;
    }
  }

  static void check(std::size_t path, std::size_t step, double nu) {
    if (!(nu > 0 && nu <= kMaxVolumeFraction))
      throw InvalidInput(fmt::format("path {}, step {}: the volume fraction {:.6g} is outside (0, {}]", path, step, nu,
                                     kMaxVolumeFraction));
  }
};

/// Whether the state is jammed without doubt, so that it was so on the whole step that led there.
bool is_clear(const LawState<double>& state, double nu, double nu_c) {
  return as_vector(state).allFinite() && state.P > 0 && nu > nu_c &&
         least_principal_stress(state.P, state.sigma) > kClearOfTension * state.P;
}

class Follower {
 public:
  Follower(const LawParameters<double>& parameters, Rung rung, Coupling coupling, double accuracy)
      : parameters_(parameters), rung_(rung), coupling_(coupling), accuracy_(accuracy) {
    if (rung != Rung::reduced) walker_.emplace(Integrator::dopri_5, accuracy, parameters, rung, coupling, kMostSteps);
  }

  /// States at the ends of the segments.
  std::vector<LawState<double>> follow(const std::vector<StraightSegment>& segments, const LawState<double>& start,
                                       const RunControl& control) {
    if (walker_) {
      try {
        Walk walk = walker_->walk(segments, start);
        const double nu_c = parameters_.isotropic.pressure.nu_c;
        bool clear = true;
        for (std::size_t k = 0; k < segments.size() && clear; ++k)
          clear = is_clear(walk.ends[k], segments[k].nu(segments[k].length), nu_c);
        if (clear) return std::move(walk.ends);
      } catch (const NotConverged&) {  // perhaps because it unjams
      }
    }
    std::vector<OutputPoint> ends;
    for (std::size_t k = 0; k < segments.size(); ++k) ends.push_back({static_cast<int>(k), segments[k].length});
    const PathStart from{start, {}, {}};
    const Tolerances tolerances{accuracy_, 1e-4 * accuracy_};
    std::vector<LawState<double>> states;
    const auto keep = [&](const LawState<double>& state, const std::vector<LawState<double>>&) {
      states.push_back(state);
    };
    if (rung_ == Rung::reduced)
      walk_reduced(parameters_, segments, from, ends, control, keep);
    else
      walk_integrated(parameters_, rung_, coupling_, segments, from, ends, tolerances, control, keep);
    return states;
  }

 private:
  const LawParameters<double>& parameters_;
  Rung rung_;
  Coupling coupling_;
  double accuracy_;
  std::optional<Walker> walker_;
};

}  // namespace

std::vector<LawState<double>> states_along(const StrainBatch& batch, const LawParameters<double>& parameters, Rung rung,
                                           Coupling coupling, double accuracy, int threads, const RunControl& control) {
  std::vector<LawState<double>> states(batch.paths * batch.steps);
  in_ranges(batch.paths, threads, [&](std::size_t first, std::size_t end) {
    Follower follower(parameters, rung, coupling, accuracy);
    History history;
    for (std::size_t path = first; path < end; ++path) {
      if (control.stop.stop_requested()) throw Interrupted("the batch was interrupted");
      history.read(batch, path);
      LawState<double> state;
      std::vector<LawState<double>> ends;
      try {
        state = state_from_law(parameters, batch.nu[path]);
        ends = follower.follow(history.segments, state, control);
      } catch (const InvalidInput& error) {
        throw InvalidInput(fmt::format("path {}: {}", path, error.what()));
      } catch (const NotConverged& error) {
        throw NotConverged(fmt::format("path {}: {}", path, error.what()));
      }
      std::size_t next = 0;
      for (std::size_t step = 0; step < batch.steps; ++step) {
        if (next < history.steps.size() && history.steps[next] == step) state = ends[next++];
        states[path * batch.steps + step] = state;
      }
    }
  });
  return states;
}

}  // namespace grainlaw::predict
