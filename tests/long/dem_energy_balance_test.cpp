// D9 at N = 1000 and three densities: the residual of the energy balance over the dissipation. The quick version and
// the description are in tests/verification/dem/energy_balance_test.cpp. What contacts that begin or end leave is 9e-5 of what
// is lost, by one packing more and by another less (2e-5 to 1.4e-4): three had summed to 1.04e-4.

#include <gtest/gtest.h>

#include "tests/support/dem_compression.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

TEST(EnergyBalanceLong, D9ThousandSpheresAtThreeDensities) {
  for (const double nu : {0.70, 0.75, 0.82}) {
    const scene::EnergyAccount account = scene::compress_several(1000, nu, 12, 50);
    testing::expect_figure(fmt::format("D9.nu{:.2f}.N1000", nu), account.residual_over_lost(), 1e-4);
  }
}

}  // namespace
}  // namespace grainlaw::dem
