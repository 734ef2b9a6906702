#pragma once
// Hard cases F2 and F3: how often the 95 % interval, value +- t standard errors, contains the truth. Noise of a given size on
// every measured quantity of every row but the first of a test (which is the start that the model is given):
//   P*, C*, phi_r, <delta>/<r>, F_v: relative to the value;  sigma'/P and F': of their largest norm in the test
// white or correlated from row to row (AR(1)); on top, if asked for, a factor for each packing and quantity, common to all
// its rows and tests. Fresh data of the same truth each time.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <thread>

#include "fit/calibrate.hpp"
#include "fit/staged_laws.hpp"
#include "fit/stages/density_fit.hpp"
#include "tests/support/coverage_count.hpp"
#include "tests/support/fit_stages.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::testing {

/// Parameters whose limits of Eq. (20) lie inside their bounds: an interval around a bound is none.
inline LawParameters<double> interior_truth() {
  LawParameters<double> p = synthetic_truth();
  p.fabric_max = {0.05, 0.12, 9};
  p.fabric_rate = {10, 48, 8};
  return p;
}

/// One kind of data, and how many sets of it.
struct CoverageStudy {
  int sets = 0, packings = 0;
  double correlation = 0;      ///< rho of AR(1) from row to row; 0: white
  double packing_scatter = 0;  ///< standard deviation of a packing's factors, relative
  std::uint64_t first_seed = 0;
  fit::Loss loss = fit::Loss::squares;
  int priors = 0;            ///< moderated by so many priors in turn, each of many packings of the same kind; 0: not
  std::uint64_t others = 0;  ///< studies that share this number share their priors; 0: first_seed

  std::string name() const {
    return fmt::format("{}_packings{}{}{}{}", packings,
                       correlation > 0 ? fmt::format("_rho_{:g}", correlation) : "_white",
                       packing_scatter > 0 ? fmt::format("_scatter_{:g}", packing_scatter) : "",
                       loss == fit::Loss::huber ? "_huber" : "", priors > 0 ? "_moderated" : "");
  }

  std::uint64_t first_other() const { return others > 0 ? others : first_seed; }

  /// Likewise, of other data.
  CoverageStudy with(int other_packings, std::uint64_t other_first_seed) const {
    CoverageStudy other = *this;
    other.packings = other_packings;
    other.first_seed = other_first_seed;
    return other;
  }
};

/// Calls work(0), ..., work(n - 1) on all processors, the first ones first.
template <class Work>
void in_parallel(int n, Work work) {
  std::atomic<int> next = 0;
  std::vector<std::jthread> team;
  for (unsigned t = 0; t < std::max(1u, std::thread::hardware_concurrency()); ++t)
    team.emplace_back([&] {
      for (int i = next++; i < n; i = next++) work(i);
    });
}

/// The study's priors, as many packings of the same kind that are not judged, as one would simulate once, give them: 64, and 16 sets each of
/// 2, 3 and 5; `fitted` being a fit to set k of a study's data. One prior is itself off by chance (64 packings know a standard
/// error to 9 %), the same way for all sets: its degrees of freedom speak of the mean over priors.
template <class Fitted>
std::vector<fit::VariancePrior> priors_of(const CoverageStudy& study, Fitted fitted) {
  constexpr std::array<int, 3> kFew{2, 3, 5};
  constexpr int kSets = 16, kParts = kSets * static_cast<int>(kFew.size());
  const auto seed = [&](int which) {
    return 1000000000 + 100 * study.first_other() + 10000 * static_cast<std::uint64_t>(which);
  };
  std::vector<fit::SizedLaw> many(static_cast<std::size_t>(study.priors)),
      parts(static_cast<std::size_t>(study.priors * kParts));
  in_parallel(study.priors * (1 + kParts), [&](int job) {
    if (job < study.priors) {
      many[static_cast<std::size_t>(job)] = fitted(study.with(64, seed(job)), 0);
      return;
    }
    const int part = job - study.priors, packings = kFew[static_cast<std::size_t>(part % kParts / kSets)];
    const std::uint64_t first = seed(part / kParts) + 1000 * static_cast<std::uint64_t>(packings);
    parts[static_cast<std::size_t>(part)] = fitted(study.with(packings, first), part % kSets);
  });
  std::vector<fit::VariancePrior> priors;
  for (int which = 0; which < study.priors; ++which) {
    const auto first = parts.begin() + which * kParts;
    priors.push_back(fit::variance_prior(many[static_cast<std::size_t>(which)], {first, first + kParts}));
  }
  return priors;
}

class RowNoise {
 public:
  /// `size` of the noise of a row; the factors of the packings are drawn once.
  RowNoise(double size, std::uint64_t seed, double correlation = 0, double packing_scatter = 0)
      : size_(size), correlation_(correlation), packing_scatter_(packing_scatter), engine_(seed) {}

  double factor() { return 1 + size_ * normal_(engine_); }

  void add_to(TestRecord& test) {
    const Deviator<double> N = shear_direction(resolve(test.path));
    double s_scale = 0, F_scale = 0;
    for (const Observation& row : test.rows) {
      if (row.P_star > 0) s_scale = std::max(s_scale, row.s_dev);
      F_scale = std::max(F_scale, row.F_dev);
    }
    const Factors& packing = factors_of(test.packing.seed);
    started_ = false;
    for (std::size_t i = 0; i < test.rows.size(); ++i) {
      Observation& row = test.rows[i];
      std::array<double, 15> noise{};
      if (i > 0) advance();
      if (i > 0) noise = state_;
      const auto relative = [&](std::size_t k) { return 1 + size_ * noise[k]; };
      Deviator<double> of_s, of_F;
      for (int k = 0; k < 5; ++k) {
        of_s(k) = size_ * s_scale * noise[static_cast<std::size_t>(5 + k)];
        of_F(k) = size_ * F_scale * noise[static_cast<std::size_t>(10 + k)];
      }
      const double P = row.stress.tensor.trace() / 3;
      const Deviator<double> q = packing.s * deviator<double>(row.stress.tensor) / (P > 0 ? P : 1) + of_s;
      const Deviator<double> F = packing.F * deviator<double>(row.fabric.tensor) + of_F;
      const double f = packing.P * relative(0);
      row.stress.tensor = P * f * (Eigen::Matrix3d::Identity() + tensor_of(q));
      row.P_star *= f;
      row.F_v *= relative(1);
      row.fabric.tensor = tensor_of(F) + row.F_v / 3 * Eigen::Matrix3d::Identity();
      row.C_star *= packing.C * relative(2);
      row.rattler_fraction *= packing.phi * relative(3);
      row.mean_overlap *= relative(4);
      // What follows from these.
      row.C = (1 - row.rattler_fraction) * row.C_star;
      row.F_v = row.fabric.tensor.trace();
      row.F_dev = F.norm();
      if (P > 0) row.s_dev = q.norm();
      if (N.isZero()) continue;
      row.F_par = F.dot(N);
      if (P > 0) row.s_par = q.dot(N);
    }
  }

 private:
  struct Factors {
    double P = 1, C = 1, phi = 1, s = 1, F = 1;
  };

  const Factors& factors_of(std::uint64_t seed) {
    const auto [at, fresh] = factors_.try_emplace(seed);
    if (fresh && packing_scatter_ > 0) {
      Factors& f = at->second;
      for (double* factor : {&f.P, &f.C, &f.phi, &f.s, &f.F}) *factor += packing_scatter_ * normal_(engine_);
    }
    return at->second;
  }

  void advance() {
    const double fresh = started_ ? std::sqrt(1 - correlation_ * correlation_) : 1, kept = started_ ? correlation_ : 0;
    for (double& x : state_) x = kept * x + fresh * normal_(engine_);
    started_ = true;
  }

  double size_, correlation_, packing_scatter_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  std::map<std::uint64_t, Factors> factors_;
  std::array<double, 15> state_{};  // of each quantity and coordinate
  bool started_ = false;
};

inline constexpr double kNoise = 0.01;

/// Eqs. (11), (12), (14), (13) and g3 from the ISO unloading of the packings: of set `k`, without moderation.
inline fit::SizedLaw fit_of_isotropic_laws(const CoverageStudy& study, int k) {
  const LawParameters<double> truth = interior_truth();
  SyntheticOptions options;
  options.rows = 40;
  SyntheticDataset maker(truth, options);
  std::vector<TestRecord> tests{
      maker.test("d2", 1, 0.70, {synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.05)})};  // a data set needs one
  for (int seed = 1; seed <= study.packings; ++seed)
    tests.push_back(maker.isotropic_unloading(static_cast<std::uint64_t>(seed)));
  fit::CalibrationOptions choices;
  choices.loss = study.loss;
  RowNoise noise(kNoise, study.first_seed + static_cast<std::uint64_t>(k), study.correlation, study.packing_scatter);
  for (TestRecord& test : tests) noise.add_to(test);
  const auto series = fit::isotropic_series(fit::check_and_sort(tests), {});
  fit::Calibration found = fit::nothing_known();
  found.law.parameters = truth;
  fit::fit_unloading_laws("F2", series, found, choices, {});
  fit::fit_overlap_law("F2", series, found, choices, {});
  found.law.covariance = found.errors.covariance();
  return {found.law, fit::size_of(tests)};
}

inline Coverage coverage_of_isotropic_laws(const CoverageStudy& study) {
  const std::vector<fit::VariancePrior> priors = priors_of(study, fit_of_isotropic_laws);
  Coverage coverage;
  for (int k = 0; k < study.sets; ++k) {
    fit::SizedLaw found = fit_of_isotropic_laws(study, k);
    if (!priors.empty()) moderate(priors[static_cast<std::size_t>(k) % priors.size()], found.size, found.law);
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      const Status status = found.law.estimates[i].status;
      const std::string name = parameter_table()[i].name;
      const bool free = name.starts_with("coordination") || name.starts_with("rattlers") ||
                        name.starts_with("pressure") || name == "overlap.D" || name == "fabric.g3";
      if (free && status != Status::fixed) coverage.add({name, found.law.estimates[i]}, interior_truth());
    }
  }
  return coverage;
}

/// Eqs. (11), (12), (14) of the steady state: one mean for each of eight densities and packings, white.
inline Coverage coverage_of_steady_laws(const CoverageStudy& study) {
  const LawParameters<double> truth = interior_truth();
  const StateLaw<double>& law = truth.steady;
  Coverage coverage;
  for (int k = 0; k < study.sets; ++k) {
    RowNoise noise(kNoise, study.first_seed + static_cast<std::uint64_t>(k));
    std::vector<fit::DensitySeries> series;
    for (int packing = 0; packing < study.packings; ++packing) {
      for (const double nu : {0.675, 0.68, 0.69, 0.70, 0.72, 0.75, 0.78, 0.82}) {
        fit::DensityPoint point{nu,
                                law.coordination.C_star(nu) * noise.factor(),
                                law.rattlers.fraction(nu, law.coordination.nu_c) * noise.factor(),
                                0,
                                1,
                                1};
        point.P_star = law.P_star(nu) * noise.factor();
        series.push_back({fmt::format("d2-{}-{}", nu, packing), packing, 0, {point}});
      }
    }
    LawParameters<double> found = truth;
    for (const fit::StageFit& fit : run_stages(fit::state_law_stages(fit::kSteadyLaw, series, "F2"), found))
      coverage.add(fit.stage.estimates, truth);
  }
  return coverage;
}

/// Of each parameter over the calibrations.
inline LawParameters<double> medians(const std::vector<CalibratedLaw>& found) {
  LawParameters<double> middle;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    std::vector<double> values;
    for (const CalibratedLaw& law : found) values.push_back(law.estimates[i].value);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), at, values.end());
    *fields(middle)[i] = *at;
  }
  return middle;
}

/// The complete calibration, all stages, of data that the memory rung made: ISO unloading, D2 at three densities, D3 and
/// D2->ISO at one, of each packing. Truth is what the same calibration finds without noise: the parameters of Eq. (16) are those
/// that meet such data best. By Huber's loss, whose reach is the noise's, it is the median over the sets. Few rows and long
/// steps, for speed; they are the same for the truth. lambda and kappa are as fitted to the paper's data: with lambda = 150 the
/// fabric has caught up within a third of a row, and 12 rows cannot tell the two apart.
class CompleteCalibration {
 public:
  CompleteCalibration() : truth_(interior_truth()) {
    truth_.memory = {0.8, 0.7, 2.5, 26, 40, 10, 1.1, 0.7, 0.67, 1.18};
    truth_.lode = {0.03, 0.8};
  }

  /// Without noise.
  std::vector<TestRecord> clean(int packings) const {
    SyntheticOptions options;
    options.rows = 12;
    options.rung = Rung::memory;
    SyntheticDataset maker(truth_, options);
    std::vector<TestRecord> tests;
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(packings); ++seed) {
      tests.push_back(maker.isotropic_unloading(seed));
      for (const double nu : {0.68, 0.72, 0.80}) {
        tests.push_back(maker.test(fmt::format("d2-{}-s{}", nu, seed), seed, nu,
                                   {synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.24)}));
      }
      tests.push_back(maker.test(fmt::format("d3-s{}", seed), seed, 0.80,
                                 {synthetic_segment(Mode::D3, ExtentKind::eps_dev, 0.24)}));
      tests.push_back(maker.test(fmt::format("d2-iso-s{}", seed), seed, 0.70,
                                 {synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.15),
                                  synthetic_segment(Mode::ISO, ExtentKind::target_nu, 0.73)}));
    }
    return tests;
  }

  static fit::SizedLaw fitted(const std::vector<TestRecord>& tests, fit::Loss loss) {
    fit::CalibrationOptions options;
    options.max_step = 1e-2;
    options.stiffness_window = 0.04;
    options.loss = loss;
    return {fit::calibrate(tests, options, {}).law, fit::size_of(tests)};
  }

  /// Set `k` of the study.
  fit::SizedLaw fitted(const CoverageStudy& study, int k) const { return fitted(clean(study.packings), study, k); }

  static fit::SizedLaw fitted(std::vector<TestRecord> tests, const CoverageStudy& study, int k) {
    RowNoise noise(kNoise, study.first_seed + static_cast<std::uint64_t>(k), study.correlation, study.packing_scatter);
    for (TestRecord& test : tests) noise.add_to(test);
    return fitted(tests, study.loss);
  }

  /// What is found without any noise.
  LawParameters<double> without_noise(const CoverageStudy& study) const {
    return fitted(clean(study.packings), study.loss).law.parameters;
  }

  /// Made once for the studies that share them.
  const std::vector<fit::VariancePrior>& priors(const CoverageStudy& study) const {
    static std::map<std::pair<std::uint64_t, int>, std::vector<fit::VariancePrior>> made;
    const auto [at, fresh] = made.try_emplace({study.first_other(), study.priors});
    if (fresh) at->second = priors_of(study, [&](const CoverageStudy& other, int k) { return fitted(other, k); });
    return at->second;
  }

 private:
  LawParameters<double> truth_;
};

/// The sets of a study, moderated if it asks for that.
inline std::vector<CalibratedLaw> calibrations_of(const CoverageStudy& study) {
  const CompleteCalibration scene;
  const std::vector<TestRecord> clean = scene.clean(study.packings);
  std::vector<CalibratedLaw> found(static_cast<std::size_t>(study.sets));
  const std::vector<fit::VariancePrior>& priors = scene.priors(study);
  in_parallel(study.sets, [&](int k) {
    fit::SizedLaw one = CompleteCalibration::fitted(clean, study, k);
    if (!priors.empty()) moderate(priors[static_cast<std::size_t>(k) % priors.size()], one.size, one.law);
    found[static_cast<std::size_t>(k)] = one.law;
  });
  return found;
}

inline Coverage coverage_about(const LawParameters<double>& truth, const std::vector<CalibratedLaw>& found) {
  Coverage coverage;
  for (const CalibratedLaw& law : found) {
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      const std::string name = parameter_table()[i].name;
      // Not fitted:
      if (name == "shear.nu_c" || name == "memory.m" || name == "memory.a_P" || name == "anisotropy.a0") continue;
      coverage.add({name, law.estimates[i]}, truth);
    }
  }
  return coverage;
}

inline Coverage coverage_of_calibration(const CoverageStudy& study) {
  const std::vector<CalibratedLaw> found = calibrations_of(study);
  const CompleteCalibration scene;
  if (study.loss == fit::Loss::huber) return coverage_about(medians(found), found);
  return coverage_about(scene.without_noise(study), found);
}

}  // namespace grainlaw::testing
