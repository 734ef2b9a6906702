#pragma once
// The keys that SPEC and TEST share: packing, material, engine, driving and densities of the preparation.

#include <string>

#include "model/files/json_document.hpp"
#include "dem/element_tests/preparation.hpp"

namespace grainlaw::dem {

/// Takes the keys that are present into `options`; the document has passed its schema.
void read_preparation(const Json& document, PreparationOptions& options);

/// All keys, defaults included; kept states and threads are left out. `with_fixed`: also what results depend on besides the
/// keys of SPEC and TEST, so that no two preparations that differ are written alike.
OrderedJson preparation_to_json(const PreparationOptions& options, bool with_fixed = false);

/// What no schema can say: order of the densities, kept densities on their branches, contacts not overdamped, a number
/// of steps that can be finished. Sets nu_end when it is not given. Throws InvalidInput "NAME: KEY: ...".
void complete_preparation(PreparationOptions& options, const std::string& name);

/// Steps that driving a packing of these options along `segments` takes, estimated from the mean size distribution.
double expected_steps(const PreparationOptions& options, const std::vector<StraightSegment>& segments);

/// Likewise of the whole preparation, without relaxation.
double expected_steps(const PreparationOptions& options);

inline constexpr double kMaxSteps = 1e10;  ///< runs that would take more are refused

}  // namespace grainlaw::dem
