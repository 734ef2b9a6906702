#pragma once
// prior.json, what many packings say of the errors of few (fit/statistics/variance_prior.hpp). Made by grainlaw study prior.

#include <filesystem>

#include "fit/statistics/variance_prior.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw::fit {

OrderedJson prior_to_json(const VariancePrior& prior);

/// Throws InvalidInput naming `name` and what is wrong: a key, a parameter, a matrix that is not square or symmetric.
VariancePrior prior_from_json(const Json& json, const std::string& name);

/// Throws InvalidInput likewise.
VariancePrior read_prior(const std::filesystem::path& file);

/// The one that is built in, fit/packing_prior.json: how it was made stands in it.
const VariancePrior& shipped_prior();

}  // namespace grainlaw::fit
