#pragma once
// Whether runs can be carried out as asked, and what they take. Errors are InvalidInput "NAME: KEY: ...".

#include <string>
#include <vector>

#include "dem/element_tests/preparation.hpp"

namespace grainlaw::dem {

/// What no schema can say of a preparation: order of the densities, kept densities on their branches, contacts not
/// overdamped, a number of steps that can be finished. Sets nu_end when it is not given, and the state to keep when
/// none is.
void complete_preparation(PreparationOptions& options, const std::string& name);

/// Throws unless a packing of these options can be driven along `path` in a number of steps that can be finished: the
/// engine follows strain-controlled segments and cells that stay upright.
void check_path(const Path& path, const PreparationOptions& options, const std::string& name);

/// Steps that driving a packing of these options along `segments` takes, estimated from the mean size distribution.
double expected_steps(const PreparationOptions& options, const std::vector<StraightSegment>& segments);

/// Likewise of the whole preparation, without relaxation.
double expected_steps(const PreparationOptions& options);

}  // namespace grainlaw::dem
