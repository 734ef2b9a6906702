// Hard case F5: the derivatives that the solver gets are those of the values that it gets. Every residual of the
// calibration at 1000 random points, bounds included, against Ridders' extrapolated central differences.

#include <gtest/gtest.h>

#include <cmath>

#include "fit/stages/density_fit.hpp"
#include "fit/stages/density_law_fit.hpp"
#include "fit/stages/evolution_fit.hpp"
#include "fit/stages/shear_fit.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/fit_random_points.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::fit {
namespace {

constexpr int kPoints = 1000;
constexpr double kPassLine = 1e-7;

const std::vector<TestRecord>& few_rows() {
  static const std::vector<TestRecord> tests = [] {
    testing::SyntheticOptions options;
    options.densities = {0.69, 0.76};
    options.seeds = {1};
    options.rows = 8;
    return testing::synthetic_dataset(testing::synthetic_truth(), options);
  }();
  return tests;
}

/// Largest error over the points; one random parameter of one random block at each.
double worst(const Problem& problem, std::uint64_t seed, double least_nu = 1) {
  const std::vector<FreeParameter>& parameters = problem.parameters;
  const std::vector<ResidualBlock>& blocks = problem.blocks;
  testing::RandomPoints random(seed);
  double largest = 0;
  int checked = 0;
  for (int point = 0; point < kPoints; ++point) {
    const std::vector<double> x = random.near(parameters);
    const std::size_t k = random.index(parameters.size());
    const bool density = parameters[k].name.ends_with(".nu_c");
    // Smooth between the jamming density and the lowest row; elsewhere a tenth of the parameter.
    const double step = density ? 0.3 * (least_nu - x[k]) : 0.1 * std::max(std::abs(x[k]), 0.1 * parameters[k].scale);
    const double error = testing::column_error(blocks[random.index(blocks.size())], x, k, step, random);
    if (error < 0) continue;  // P used up on the way: the block says that it is not defined
    ++checked;
    largest = std::max(largest, error);
  }
  EXPECT_GT(checked, 0.9 * kPoints);
  return largest;
}

double worst_of_density_laws() {
  const std::vector<DensitySeries> series = isotropic_series(check_and_sort(few_rows()), {});
  double largest = 0;
  for (const StageDefinition& stage : state_law_stages(kUnloadingLaw, series, ""))
    largest = std::max(largest, worst(problem_of(stage, published_parameters()), 1, stage.least_nu));
  return largest;
}

double worst_of_shear() {
  std::vector<double> e, s;
  for (int i = 0; i <= 30; ++i) {
    e.push_back(0.01 * i);
    s.push_back(0.15 * (1 - std::exp(-40 * e.back())));
  }
  return worst(saturation_problem("d2", "s_par", e, s, 0, {}), 2);
}

double worst_of_eq20() {
  std::vector<ShearFit> fits;
  for (const auto& [nu, s_max] : {std::pair{0.68, 0.19}, {0.74, 0.15}, {0.82, 0.13}}) {
    fits.emplace_back();
    fits.back().nu = nu;
    fits.back().s_max = {s_max, kUndefined, Status::fitted, ""};
  }
  return worst(problem_of(density_law_stage(kShearQuantities[0], fits, {0, 1, 2}, 0.6653, {}), start_parameters()), 3);
}

double worst_of_evolution(Coupling coupling) {
  CalibrationOptions options;
  options.coupling = coupling;
  options.max_step = 1e-2;  // derivatives are those of the discrete integrator, whatever its step
  const LawParameters<double> start = testing::synthetic_truth();
  const auto trajectories = trajectories_of(check_and_sort(few_rows()), 0.67, options);
  const StageDefinition stage = evolution_stage(trajectories, {}, options);
  return worst(problem_of(stage, start), 4, stage.least_nu);
}

TEST(FitGradients, F5) {
  testing::expect_figure("F5.density_laws", worst_of_density_laws(), kPassLine);
  testing::expect_figure("F5.shear", worst_of_shear(), kPassLine);
  testing::expect_figure("F5.eq20", worst_of_eq20(), kPassLine);
  testing::expect_figure("F5.evolution", worst_of_evolution(Coupling::energy), kPassLine);
  testing::expect_figure("F5.evolution_single", worst_of_evolution(Coupling::single), kPassLine);
}

TEST(FitGradients, TheCheckNoticesAWrongDerivative) {
  ResidualBlock block;
  block.weight = Eigen::VectorXd::Ones(1);
  block.evaluate = [](const double* x, double* r, double* J) {
    r[0] = x[0] * x[0];
    if (J != nullptr) J[0] = 2 * x[0] * (1 + 1e-6);
    return true;
  };
  testing::RandomPoints random(5);
  EXPECT_NEAR(testing::column_error(block, {3}, 0, 0.1, random), 1e-6, 1e-8);
}

}  // namespace
}  // namespace grainlaw::fit
