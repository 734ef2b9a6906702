#pragma once
// What a fit can leave out of a data set, or do differently, as changes of the fit of everything:
//   rows_every=k       every k-th row of each segment, its ends always
//   packings=n         the first n packings by seed
//   densities_every=k  of the tests of one path every k-th density, the lowest always
//   shear_strain=f     shear at constant volume up to this fraction of its strain; costs as much less
//   loss=huber         rows that are far off count for less

#include "chain/studies/settings_study.hpp"
#include "fit/data/options.hpp"
#include "model/files/dataset.hpp"

namespace grainlaw::chain {

struct FitChoice {
  Dataset dataset;
  fit::CalibrationOptions options;
};

/// Throws InvalidInput naming a change that is none of these, or that leaves nothing.
FitChoice chosen(const FitChoice& everything, const Changes& changes);

/// One change each, as far as the data set has something to leave out: rows_every 2, 4, 8; packings, halved until 2;
/// densities_every 2; shear_strain 0.75, 0.5; loss huber.
std::vector<std::string> usual_choices(const Dataset& dataset);

}  // namespace grainlaw::chain
