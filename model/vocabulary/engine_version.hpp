#pragma once
// Version of the engine's results. Finished runs are found again by the digest of their spec and this number, so raise
// it with every change that moves any bit of a series or of a state.

namespace grainlaw {

inline constexpr int kEngineVersion = 4;

}  // namespace grainlaw
