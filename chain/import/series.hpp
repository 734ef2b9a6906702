#pragma once
// Tables of others as rows in our units and signs: strain tension positive and logarithmic, stress compression positive in Pa.
//   edges         eps_ii = ln(L_i/L_i0)
//   nominal       eps = ln(1 + e), e the change of length over the first length (shears must vanish)
//   engineering   eps_ij = gamma_ij/2
//   triaxial      eps_r = (eps_v - eps_a)/2;  sigma_a = p + 2q/3, sigma_r = p - q/3, a the axis, r across it
//   isotropic     eps = -ln(nu/nu_0) I/3, sigma = p I
//   nu            as given, 1/(1 + e) of the void ratio, 1 - n of the porosity, or nu_0 exp(-eps_vol)
// Strain counts from the first row.

#include "chain/import/foreign_rows.hpp"
#include "chain/import/mapping.hpp"

namespace grainlaw::chain {

/// Reads the table of `test`. Throws InvalidInput naming file, line (or row) and column: what is missing, no number, in no known
/// unit, or of a sign that is neither told nor evident, or the other way round.
ForeignRows read_series(const Mapping& mapping, const TestMapping& test);

}  // namespace grainlaw::chain
