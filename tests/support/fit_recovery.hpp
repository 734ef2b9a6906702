#pragma once
// Hard case F1: noise-free data of a known law, fits started far away. A start either ends at the truth to 1e-8 or is
// flagged as not converged; anything else is a silent error.

#include <cmath>
#include <random>

#include "fit/stages/density_fit.hpp"
#include "fit/stages/evolution_fit.hpp"
#include "tests/support/fit_stages.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::testing {

struct RecoveryCount {
  int starts = 0, recovered = 0, flagged = 0;
  int silent() const { return starts - recovered - flagged; }  ///< wrong without a word
};

/// Multiplies by a factor within 1/3 ... 3, uniform in its logarithm; moves jamming densities within +-0.005.
class FarStart {
 public:
  explicit FarStart(std::uint64_t seed) : engine_(seed) {}
  double factor(double value) { return value * std::exp(uniform(-std::log(3.0), std::log(3.0))); }
  double density(double value) { return value + uniform(-0.005, 0.005); }
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }

 private:
  std::mt19937_64 engine_;
};

inline bool same(double found, double truth, double scale) { return std::abs(found - truth) <= 1e-8 * scale; }

/// Eqs. (11), (12), (14) on the isotropic branch.
inline RecoveryCount recover_state_law(int starts, std::uint64_t seed) {
  const LawParameters<double> truth = synthetic_truth();
  SyntheticOptions options;
  options.densities = {0.70};
  options.sequences = false;
  options.seeds = {1};
  options.rows = 60;
  const std::vector<TestRecord> tests = synthetic_dataset(truth, options);
  const auto series = fit::isotropic_series(fit::check_and_sort(tests), {});
  FarStart far(seed);
  RecoveryCount count;
  for (; count.starts < starts; ++count.starts) {
    LawParameters<double> found = truth;
    StateLaw<double>& law = found.isotropic;
    for (double* p : {&law.coordination.C1, &law.coordination.alpha, &law.rattlers.phi_c, &law.rattlers.phi_v,
                      &law.pressure.p0, &law.pressure.gamma_p}) {
      *p = far.factor(*p);
    }
    law.coordination.nu_c = far.density(law.coordination.nu_c);
    law.pressure.nu_c = far.density(law.pressure.nu_c);
    bool converged = true;
    for (const fit::StageFit& fit : run_stages(fit::state_law_stages(fit::kUnloadingLaw, series, "F1"), found)) {
      converged = converged && fit.stage.converged;
    }
    const auto a = fields(found);
    const auto b = fields(truth);
    bool recovered = true;
    for (std::size_t i = 0; i < kParameterCount; ++i) recovered = recovered && same(*a[i], *b[i], std::abs(*b[i]));
    if (!converged)
      ++count.flagged;
    else if (recovered)
      ++count.recovered;
  }
  return count;
}

/// Eq. (16) on all trajectories at once: D2 at four densities, D2->ISO at two, ISO unloading.
inline RecoveryCount recover_evolution(int starts, std::uint64_t seed) {
  const LawParameters<double> truth = synthetic_truth();
  SyntheticOptions options;
  options.rows = 20;
  SyntheticDataset set(truth, options);
  std::vector<TestRecord> tests{set.isotropic_unloading(1)};
  for (const double nu : {0.68, 0.70, 0.74, 0.80}) {
    tests.push_back(
        set.test(fmt::format("d2-{}", nu), 1, nu, {synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.25)}));
  }
  for (const double nu : {0.69, 0.77}) {
    tests.push_back(set.test(fmt::format("d2-iso-{}", nu), 1, nu,
                             {synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.15),
                              synthetic_segment(Mode::ISO, ExtentKind::target_nu, nu + 0.03)}));
  }
  fit::CalibrationOptions calibration;
  calibration.max_step = 1.2e-3;  // the integrator's own error then stays below 1e-9
  const auto trajectories =
      fit::trajectories_of(fit::check_and_sort(tests), truth.isotropic.pressure.nu_c, calibration);
  FarStart far(seed);
  RecoveryCount count;
  for (; count.starts < starts; ++count.starts) {
    LawParameters<double> law = truth;
    for (ExponentialLaw<double>* q : {&law.stress_ratio_max, &law.stress_rate, &law.fabric_max, &law.fabric_rate}) {
      q->Q_limit = q->Q_limit > 0 ? far.factor(q->Q_limit) : far.uniform(0, q->Q_c / 3);
      q->Q_c = far.factor(q->Q_c);
      q->alpha = far.factor(q->alpha);
    }
    law.isotropic.pressure.p0 = far.factor(law.isotropic.pressure.p0);
    law.isotropic.pressure.gamma_p = far.factor(law.isotropic.pressure.gamma_p);
    law.isotropic.pressure.nu_c = far.density(law.isotropic.pressure.nu_c);
    law.anisotropy.a2 = far.factor(law.anisotropy.a2);
    const fit::StageFit fit = run_stage(fit::evolution_stage(trajectories, {}, calibration), law, calibration, {});
    bool recovered = true;
    for (const fit::NamedEstimate& e : fit.stage.estimates) {
      const std::size_t i = parameter_index(e.name);
      const double expected = *fields(truth)[i];
      // A limit of zero is measured by the Q_c that stands next to it.
      const double scale = expected != 0 ? std::abs(expected) : std::abs(*fields(truth)[i + 1]);
      recovered = recovered && same(e.estimate.value, expected, scale);
    }
    if (!fit.stage.converged)
      ++count.flagged;
    else if (recovered)
      ++count.recovered;
  }
  return count;
}

}  // namespace grainlaw::testing
