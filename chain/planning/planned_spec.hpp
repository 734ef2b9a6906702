#pragma once
// The SPEC of a plan: the user's frame (material, size distribution, branches, tests) with the settings that a plan chooses.

#include <vector>

#include "chain/planning/precision_plan.hpp"
#include "dem/runs/spec_file.hpp"

namespace grainlaw::chain {

/// Volume fractions at which a plan shears for a prediction along `path`: `count` evenly over those that the path goes
/// through, within what is fitted and prepared, and no closer together than .08 in all; rounded to .001.
std::vector<double> densities_for(const Path& path, int count, const dem::PreparationOptions& frame);

/// `frame` with the settings; seeds follow the frame's. Of the calibration tests, D2 and D3 start at the plan's densities and go
/// to its strain, D2-ISO starts at three spread over the same range; others stay as they are. Other roles stay, too. Its last
/// test is a rehearsal: `path` itself, of role validation, on every packing.
dem::Spec planned_spec(const dem::Spec& frame, const PlanSettings& settings, const Path& path);

inline constexpr const char* kRehearsal = "rehearsal";

/// With the calibration tests and the rehearsal alone, from the same packings: what is run before the plan has ended.
dem::Spec rounds_of(dem::Spec planned);

/// Work of one packing in the rounds.
Work work_of(const dem::Spec& planned);

/// What the pilot has: small packings, driven fast, by a power of two faster than the frame's. InvalidInput with `name`, the
/// frame's file, where there is nothing to plan.
PlanSettings pilot_settings(const dem::Spec& frame, const std::string& name);

/// What a plan chooses from, the pilot's settings among it, from the `wanted_rate` on; the number of packings is the pilot's
/// in all.
std::vector<PlanSettings> plan_grid(const PlanSettings& pilot, double wanted_rate);

/// Shear strains of the grid.
std::vector<double> plan_strains(const PlanSettings& pilot);

}  // namespace grainlaw::chain
