#include "dem/element_tests/preparation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "model/vocabulary/error.hpp"
#include "tests/support/dem_reference.hpp"
#include "tests/support/dem_scene.hpp"

namespace grainlaw::dem {
namespace {

/// A preparation that is over within a second: few spheres, high rates, a short loop.
PreparationOptions small_options() {
  PreparationOptions options;
  options.packing.particles = 60;
  options.drive.strain_rate = 2000;
  options.gas_compression_factor = 2;
  options.nu_max = 0.74;
  options.keep_loading = {0.74, 0.70};
  options.keep_unloading = {0.69, 0.72, 0.69, 0.71};
  options.rows = 25;
  return options;
}

struct Prepared {
  std::vector<KeptState> kept;
  std::map<Branch, std::vector<Observation>> series;
  std::vector<std::string> order;  // of what the sink received
};

Prepared prepare(const PreparationOptions& options) {
  Prepared result;
  PreparationSink sink;
  sink.keep = [&](const KeptState& kept) {
    result.kept.push_back(kept);
    result.order.push_back("keep " + to_string(kept.branch));
  };
  sink.series = [&](Branch branch, const std::vector<Observation>& rows) {
    result.series[branch] = rows;
    result.order.push_back("series " + to_string(branch));
  };
  prepare(options, sink, {});
  return result;
}

TEST(Preparation, KeepsTheRequestedStatesRelaxedAndInOrder) {
  const Prepared result = prepare(small_options());
  const std::vector<std::pair<Branch, double>> expected{{Branch::loading, 0.70},
                                                        {Branch::loading, 0.74},
                                                        {Branch::unloading, 0.72},
                                                        {Branch::unloading, 0.71},
                                                        {Branch::unloading, 0.69}};
  ASSERT_EQ(result.kept.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const KeptState& kept = result.kept[i];
    EXPECT_EQ(kept.branch, expected[i].first);
    EXPECT_EQ(kept.nu, expected[i].second);
    EXPECT_NEAR(volume_fraction(kept.state.packing), kept.nu, 1e-14);
    EXPECT_EQ(kinetic_energy(kept.state.packing), 0);
    EXPECT_EQ(kept.state.seed, 1u);
    const ReferenceSums sums = reference_sums(kept.state.packing, kept.state.material, scene::at_rest(kept.state));
    double largest = 0;
    for (const Eigen::Vector3d& f : sums.force) largest = std::max(largest, f.norm());
    EXPECT_TRUE(kept.relaxation.relaxed);
    EXPECT_LE(largest, 1.0001e-5 * kept.relaxation.mean_contact_force);
  }
  const std::vector<std::string> order{"keep loading",   "keep loading",   "series loading",  "keep unloading",
                                       "keep unloading", "keep unloading", "series unloading"};
  EXPECT_EQ(result.order, order);
}

TEST(Preparation, KeepsTheEndsOfItsBranchesToo) {
  PreparationOptions options = small_options();
  options.keep_loading = {options.nu_start, options.nu_max};
  options.keep_unloading = {options.nu_start, options.nu_max};
  const Prepared result = prepare(options);
  ASSERT_EQ(result.kept.size(), 4u);
  const std::vector<double> densities{0.64, 0.74, 0.74, 0.64};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(result.kept[i].nu, densities[i]);
    EXPECT_EQ(result.kept[i].branch, i < 2 ? Branch::loading : Branch::unloading);
    EXPECT_NEAR(volume_fraction(result.kept[i].state.packing), densities[i], 1e-14);
  }
  // both sides of the turn: one step of the branch lies between them
  const auto &before = result.kept[1].state.packing.sx, &after = result.kept[2].state.packing.sx;
  double apart = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    apart = std::max(apart, std::abs(std::remainder(before[i] - after[i], 1.0)));
  }
  EXPECT_LT(apart, 1e-3);
}

TEST(Preparation, SeriesCoverTheBranches) {
  const Prepared result = prepare(small_options());
  const auto& loading = result.series.at(Branch::loading);
  const auto& unloading = result.series.at(Branch::unloading);
  ASSERT_EQ(loading.size(), 26u);
  ASSERT_EQ(unloading.size(), 26u);
  EXPECT_NEAR(loading.front().nu, 0.64, 1e-13);
  EXPECT_NEAR(loading.back().nu, 0.74, 1e-13);
  EXPECT_NEAR(unloading.front().nu, 0.74, 1e-13);
  EXPECT_NEAR(unloading.back().nu, 0.69, 1e-13) << "unloading ends at the lowest kept density";
  for (std::size_t i = 1; i < loading.size(); ++i) {
    EXPECT_GT(loading[i].nu, loading[i - 1].nu);
    EXPECT_LT(unloading[i].nu, unloading[i - 1].nu);
    EXPECT_TRUE(std::isnan(loading[i].s_par)) << "an isotropic path has no shear direction";
  }
  EXPECT_EQ(unloading.front().P_star, loading.back().P_star) << "unloading goes on where loading ended";
  EXPECT_GT(loading.back().P_star, 0.02);
}

TEST(Preparation, IsAFunctionOfItsOptions) {
  const Prepared a = prepare(small_options()), b = prepare(small_options());
  ASSERT_EQ(a.kept.size(), b.kept.size());
  for (std::size_t i = 0; i < a.kept.size(); ++i) {
    EXPECT_EQ(a.kept[i].state.packing.sx, b.kept[i].state.packing.sx);
    EXPECT_EQ(a.kept[i].state.packing.H, b.kept[i].state.packing.H);
  }
  PreparationOptions other = small_options();
  other.packing.seed = 2;
  EXPECT_NE(prepare(other).kept[0].state.packing.sx, a.kept[0].state.packing.sx);
}

// The branches run through: what is kept does not change them.
TEST(Preparation, KeepingDoesNotDisturbTheBranches) {
  const Prepared with = prepare(small_options());
  PreparationOptions options = small_options();
  options.nu_end = 0.69;
  options.keep_loading.clear();
  options.keep_unloading.clear();
  const Prepared without = prepare(options);
  EXPECT_TRUE(without.kept.empty());
  for (const Branch branch : {Branch::loading, Branch::unloading}) {
    const auto &a = with.series.at(branch), &b = without.series.at(branch);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].E_pot, b[i].E_pot);
      EXPECT_EQ(a[i].E_kin, b[i].E_kin);
    }
  }
}

TEST(Preparation, RefusesDensitiesOutOfRange) {
  const auto refusal = [](auto change) -> std::string {
    PreparationOptions options = small_options();
    change(options);
    try {
      prepare(options);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_TRUE(refusal([](auto& o) { o.nu_max = 0.95; }).starts_with("nu_gas, nu_start, nu_max"));
  EXPECT_TRUE(refusal([](auto& o) { o.nu_start = 0.2; }).starts_with("nu_gas, nu_start, nu_max"));
  EXPECT_TRUE(refusal([](auto& o) { o.nu_max = std::nan(""); }).starts_with("nu_gas, nu_start, nu_max"));
  EXPECT_TRUE(refusal([](auto& o) { o.keep_loading = {0.639}; }).starts_with("densities"));
  EXPECT_TRUE(refusal([](auto& o) { o.keep_loading = {0.75}; }).starts_with("densities"));
  EXPECT_TRUE(refusal([](auto& o) { o.keep_unloading = {0.741}; }).starts_with("densities"));
  EXPECT_TRUE(refusal([](auto& o) { o.keep_unloading = {0.6}; }).starts_with("densities"));
  EXPECT_TRUE(refusal([](auto& o) { o.keep_unloading = {std::nan("")}; }).starts_with("densities"));
  EXPECT_TRUE(refusal([](auto& o) { o.nu_end = 0.6; }).starts_with("nu_end"));
  EXPECT_TRUE(refusal([](auto& o) { o.nu_end = 0.70; }).starts_with("densities"));
  EXPECT_TRUE(refusal([](auto& o) { o.gas_compression_factor = 0; }).starts_with("gas_compression_factor"));
  EXPECT_TRUE(refusal([](auto& o) { o.packing.particles = -1; }).starts_with("particles"));
}

TEST(Preparation, StopsOnRequestAndNamesItsStages) {
  std::stop_source stop;
  RunControl control;
  control.stop = stop.get_token();
  std::vector<std::string> stages;
  control.report = [&](const Progress& progress) {
    stages.push_back(progress.stage);
    if (progress.stage == "loading") stop.request_stop();
  };
  PreparationSink sink{[](const KeptState&) {}, [](Branch, const std::vector<Observation>&) {}, {}, {}};
  EXPECT_THROW(prepare(small_options(), sink, control), Interrupted);
  EXPECT_EQ(stages.front(), "random gas");
  EXPECT_EQ(stages.back(), "loading");
}

}  // namespace
}  // namespace grainlaw::dem
