#pragma once
// Strain paths in JSON: {initial: {nu, branch}, segments: [{mode | rate_tensor | velocity_gradient, axes, reverse, free,
// extent | cycles}]}. Cycles are written out as segments when they are read.

#include <cstddef>

#include "model/files/json_document.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw {

/// `document` has passed its schema; `name` is the file and `place` the key in front of "initial" for messages, e.g. ""
/// or "tests[0].path.". A segment with both mode and rate_tensor takes the direction of the tensor and the name of the
/// mode; `both` says whether that is allowed (files written by path_to_json have both). Throws InvalidInput for whatever
/// check(path) does.
Path path_from_json(const Json& document, const std::string& name, const std::string& place, bool both);

/// Of a path, as the schema has it; the legs of cycles count, which files of ours have written out.
inline constexpr std::size_t kMaxSegments = 10000;

std::vector<PathSegment> segments_from_json(const Json& segments, const std::string& name, const std::string& place,
                                            bool both);

/// initial and segments, directions written out in full.
OrderedJson path_to_json(const Path& path);
OrderedJson segments_to_json(const std::vector<PathSegment>& segments);

Branch branch_from_json(const Json& object);  ///< key "branch"; unloading when absent

}  // namespace grainlaw
