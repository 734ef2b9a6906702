#include "dem/element_tests/energy_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace grainlaw::dem {
namespace {

constexpr double kRounding = 1e-11;  // of the energies' sum: what is lost in adding it up over a run

}  // namespace

double EnergyWatch::residual(const Observation& row, const Observation& first) {
  largest_work_ = std::max(largest_work_, std::abs(row.W_box));
  const double exchanged = first.E_kin + row.D_contact + row.D_background;
  const double imbalance = std::abs(row.energy_residual) * (std::abs(row.W_box) + exchanged);
  if (imbalance <= kRounding * (row.E_pot + row.E_kin + first.E_pot + first.E_kin)) return 0;
  return imbalance / (largest_work_ + exchanged);
}

double largest_energy_residual(const std::vector<Observation>& rows) {
  EnergyWatch watch;
  double largest = 0;
  for (const Observation& row : rows) largest = std::max(largest, watch.residual(row, rows.front()));
  return largest;
}

void Excess::note(double value, double limit, double at_nu) {
  if (!(value > limit)) return;
  ++rows;
  if (value > worst) worst = value, nu = at_nu;
}

void Excess::report(std::vector<std::string>& warnings, const char* what, double limit, std::size_t of) const {
  if (rows == 0) return;
  warnings.push_back(
      fmt::format("{} above {} in {} of {} rows, up to {:.3g} at nu = {:.4f}", what, limit, rows, of, worst, nu));
}

}  // namespace grainlaw::dem
