#pragma once
// What a pilot's runs say: how steady means scatter within and between packings, how far coarser settings lie off, and the
// seconds of work. Packings are the unit of chance, paired by seed where they are the same spheres. The bias of the time step
// is taken as the energy residual: a difference of runs at two steps is all scatter. Formulas: docs/theory/studies.md, section
// Wanted error.

#include <string>
#include <vector>

#include "chain/planning/precision_plan.hpp"
#include "model/files/dataset.hpp"

namespace grainlaw::chain {

/// Of the shear tests at constant volume, one entry for each of `strains`. `quantity`: P_star, s_par or F_par. Throws Error
/// for less than two packings or a test without steady rows.
std::vector<SteadyScatter> steady_scatter(const std::vector<TestRecord>& tests, const std::string& quantity,
                                          const std::vector<double>& strains);

struct Difference {
  double mean = 0, standard_error = 0;  ///< relative [-]
};

/// Of the same tests: isotropic unloading (for P_star) and shear at constant volume. `paired`: on the same spheres by seed.
Difference difference_of(const std::vector<TestRecord>& coarse, const std::vector<TestRecord>& fine,
                         const std::string& quantity, bool paired);

/// Mean over the tests with shear of the largest |energy residual| of their rows.
double energy_residual(const std::vector<TestRecord>& tests);

/// Seconds of work from the runs of a data set on `threads` threads and the seconds that its fit took. `work` is that of one
/// packing.
CostRates cost_rates(const Dataset& dataset, const Work& work, double fit_seconds, int threads);

}  // namespace grainlaw::chain
