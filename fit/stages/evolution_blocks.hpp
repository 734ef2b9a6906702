#pragma once
// What the fits of Eq. (16) make small, on all trajectories at once, row by row at the observed strains:
//   P*  relative to the datum, on ISO unloading only. In shear P is shown but has no weight: Eq. (16) has no dilatancy
//       (+33 % at nu = .68), and a fit of it would turn a2 (through A1) and p0 into something else.
//   s   sigma'/P with the model's own P in the model and the measured one in the data, so that a wrong level of P cancels
//   F   fabric
// The deviators along the directions of the test's own segments (s_par, F_par; one component on co-axial paths): what
// stands across them is the noise of a finite packing, and no parameter moves it.
// Weights: shear_window() of data/shear_rows.hpp, in units of the scales in CalibrationOptions; each test and quantity counts the same.

#include "fit/data/options.hpp"
#include "fit/stages/trajectory.hpp"
#include "fit/statistics/problem.hpp"

namespace grainlaw::fit {

/// One per trajectory. Of the parameters `free`, at most 16 names of parameter_table(); the others have the values of `law`.
std::vector<ResidualBlock> evolution_blocks(const std::vector<Trajectory>& trajectories,
                                            const LawParameters<double>& law, const std::vector<std::string>& free,
                                            const CalibrationOptions& options);

}  // namespace grainlaw::fit
