#pragma once
// Test records made from given parameters of the law instead of grains: what a calibration must give back.
//   ISO unloading: Eqs. (11)-(14) and F_v = g3 nu C of the isotropic branch
//   D2, D2->ISO, UNI ...: Eq. (16) by Boost.odeint (Bulirsch-Stoer, tolerance 1e-13), started from Eq. (14) without
//   deviators; C* and phi_r are those of the steady law
// Optional: the dilatancy that Eq. (16) lacks (P rises to the steady law over shear while s and F stay as they are), and
// noise, AR(1) from row to row.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "model/law.hpp"
#include "model/vocabulary/path.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::testing {

struct SyntheticOptions {
  std::vector<double> densities{0.68, 0.70, 0.74, 0.78, 0.82};  ///< of D2 and D2->ISO
  std::vector<std::uint64_t> seeds{1, 2};
  double nu_max = 0.82, nu_end = 0.64;  ///< ISO unloading from, to
  double shear_strain = 0.30;           ///< eps_dev of D2
  int rows = 120;                       ///< per segment
  bool sequences = true;                ///< D2 to eps_dev = 0.15, ISO to nu + 0.03 and back
  Rung rung = Rung::evolution;          ///< of the paths with shear
  Coupling coupling = Coupling::energy;
  double dilatancy_strain = 0;      ///< P approaches the steady law as 1 - exp(-eps_dev/this); 0: no dilatancy
  double noise_P = 0;               ///< standard deviation, relative to P [-]
  double noise_s = 0, noise_F = 0;  ///< of each deviator coordinate of sigma'/P and F' [-]
  double noise_C = 0;               ///< of C*, relative [-]
  double noise_correlation = 0;     ///< from row to row (AR(1)) [-]
  double seed_scatter = 0;          ///< standard deviation over tests of a factor on s and F, relative [-]
};

/// LawParameters of the paper with a2 and a1 of equations.md section 2, which the paper does not give.
inline LawParameters<double> synthetic_truth() {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a1 = 0.70;
  p.anisotropy.a2 = 1.18;
  return p;
}

inline PathSegment synthetic_segment(Mode mode, ExtentKind kind, double extent, bool reverse = false) {
  return {mode, direction_of(mode, "xyz", reverse), kind, extent};
}

class SyntheticDataset {
 public:
  SyntheticDataset(LawParameters<double> law, SyntheticOptions options)
      : law_(std::move(law)), options_(std::move(options)) {}

  std::vector<TestRecord> records() {
    std::vector<TestRecord> all;
    for (const std::uint64_t seed : options_.seeds) {
      all.push_back(isotropic_unloading(seed));
      for (const double nu : options_.densities) {
        all.push_back(test(fmt::format("d2-{:.4f}-s{}", nu, seed), seed, nu,
                           {synthetic_segment(Mode::D2, ExtentKind::eps_dev, options_.shear_strain)}));
        if (!options_.sequences) continue;
        all.push_back(test(fmt::format("d2-iso-{:.4f}-s{}", nu, seed), seed, nu,
                           {synthetic_segment(Mode::D2, ExtentKind::eps_dev, 0.15),
                            synthetic_segment(Mode::ISO, ExtentKind::target_nu, nu + 0.03),
                            synthetic_segment(Mode::ISO, ExtentKind::target_nu, nu, true)}));
      }
    }
    return all;
  }

  TestRecord isotropic_unloading(std::uint64_t seed) {
    TestRecord record = empty(fmt::format("iso-s{}", seed), seed, options_.nu_max,
                              {synthetic_segment(Mode::ISO, ExtentKind::target_nu, options_.nu_end, true)});
    Noise noise(seed, options_.noise_correlation);
    const StraightSegment segment = resolve(record.path).front();
    for (int i = 0; i <= options_.rows; ++i) {
      const double e = segment.length * i / options_.rows, nu = segment.nu(e);
      LawState<double> y{.P = law_.isotropic.P_star(nu)};
      record.rows.push_back(row(record, segment, 0, e, y, law_.isotropic, noise, i > 0));
    }
    return record;
  }

  /// Any path from the isotropic state at `nu`.
  TestRecord test(const std::string& name, std::uint64_t seed, double nu, const std::vector<PathSegment>& segments) {
    TestRecord record = empty(name, seed, nu, segments);
    Noise noise(std::hash<std::string>{}(name), options_.noise_correlation);
    const double factor = 1 + options_.seed_scatter * noise.normal();
    const std::vector<StraightSegment> path = resolve(record.path);
    LawState<double> y{.P = law_.isotropic.P_star(nu)};
    for (std::size_t k = 0; k < path.size(); ++k) {
      const StraightSegment& segment = path[k];
      turn_corner(options_.rung, y, law_direction(segment.direction));
      const double jump = law_.steady.P_star(segment.nu_start) / y.P - 1;  // to the steady pressure
      LawState<double> seen = y;
      for (int i = k == 0 ? 0 : 1; i <= options_.rows; ++i) {
        const double e = segment.length * i / options_.rows;
        if (i > 0) advance(segment, segment.length * (i - 1) / options_.rows, e, y);
        seen = y;
        if (options_.dilatancy_strain > 0 && std::abs(segment.eps_vol_rate()) < 1e-12) {
          const double rise = 1 + jump * (1 - std::exp(-segment.eps_dev_rate() * e / options_.dilatancy_strain));
          seen.P *= rise;
          seen.sigma *= rise;
        }
        LawState<double> scattered = seen;
        scattered.sigma *= factor;
        scattered.F *= factor;
        record.rows.push_back(row(record, segment, static_cast<int>(k), e, scattered, law_.steady, noise, i > 0));
      }
      y = seen;  // the packing goes on from where it is
    }
    double path_strain = 0;
    for (std::size_t i = 1; i < record.rows.size(); ++i) {
      path_strain += deviatoric_norm(record.rows[i].strain.tensor - record.rows[i - 1].strain.tensor);
      record.rows[i].shear_path = path_strain;
    }
    return record;
  }

 private:
  /// Standard normal draws with AR(1) memory per channel.
  class Noise {
   public:
    Noise(std::uint64_t seed, double correlation) : engine_(seed), correlation_(correlation) {}
    double normal() { return distribution_(engine_); }
    double correlated(std::size_t channel) {
      const double draw = normal();
      double& last = memory_.at(channel);
      last = started_.at(channel) ? correlation_ * last + std::sqrt(1 - correlation_ * correlation_) * draw : draw;
      started_.at(channel) = true;
      return last;
    }

   private:
    std::mt19937_64 engine_;
    std::normal_distribution<double> distribution_;
    double correlation_;
    std::array<double, 12> memory_{};
    std::array<bool, 12> started_{};
  };

  TestRecord empty(const std::string& name, std::uint64_t seed, double nu,
                   const std::vector<PathSegment>& segments) const {
    TestRecord record;
    record.name = name;
    record.path = {nu, Branch::unloading, segments};
    record.packing = {seed, 4000, 3, 1e-3 * (1 + 1e-3 * static_cast<double>(seed)), 1e8};  // every packing its own mean
    return record;
  }

  void advance(const StraightSegment& segment, double from, double to, LawState<double>& y) const {
    using Vector = std::array<double, kStateSize>;
    const LawDirection direction = law_direction(segment.direction);
    const auto pack = [](const LawState<double>& state) {
      Vector v;
      Eigen::Map<StateVector<double>> numbers(v.data());
      numbers = as_vector(state);
      return v;
    };
    const auto unpack = [](const Vector& v) {
      LawState<double> state;
      as_vector(state) = Eigen::Map<const StateVector<double>>(v.data());
      return state;
    };
    Vector v = pack(y);
    boost::numeric::odeint::bulirsch_stoer<Vector> stepper(1e-15, 1e-13);
    boost::numeric::odeint::integrate_adaptive(
        stepper,
        [&](const Vector& at, Vector& rate, double e) {
          rate = pack(law_rate(law_, options_.rung, options_.coupling, unpack(at), segment.nu(e), direction));
        },
        v, from, to, (to - from) / 4);
    y = unpack(v);
  }

  Observation row(const TestRecord& record, const StraightSegment& segment, int index, double e,
                  const LawState<double>& y, const StateLaw<double>& density, Noise& noise, bool noisy) const {
    Observation o;
    const double unit = record.packing.stress_unit(), on = noisy ? 1 : 0;
    o.segment = index;
    o.strain = segment.strain(e);
    o.eps_vol = o.strain.tensor.trace();
    o.eps_dev = deviatoric_norm(o.strain.tensor);
    o.shear_path = o.eps_dev;
    o.time = 1e-2 * (o.eps_dev + std::abs(o.eps_vol));
    o.nu = segment.nu(e);
    LawState<double> seen = y;
    seen.P *= 1 + on * options_.noise_P * noise.correlated(10);
    for (int i = 0; i < 5; ++i) {
      seen.sigma(i) = seen.P * (y.sigma(i) / std::max(y.P, 1e-300) +
                                on * options_.noise_s * noise.correlated(static_cast<std::size_t>(i)));
      seen.F(i) += on * options_.noise_F * noise.correlated(static_cast<std::size_t>(5 + i));
    }
    const double C_star = density.coordination.C_star(o.nu) * (1 + on * options_.noise_C * noise.correlated(11));
    o.C_star = C_star;
    o.rattler_fraction = density.rattlers.fraction(o.nu, density.coordination.nu_c);
    o.C = (1 - o.rattler_fraction) * C_star;
    o.C_r = o.C;
    o.F_v = law_.fabric_g3 * o.nu * o.C;
    o.fabric.tensor = tensor_of(seen.F) + o.F_v / 3 * Eigen::Matrix3d::Identity();
    o.F_v = o.fabric.tensor.trace();
    o.F_dev = seen.F.norm();
    o.stress.tensor = unit * (tensor_of(seen.sigma) + seen.P * Eigen::Matrix3d::Identity());
    o.P_star = o.stress.tensor.trace() / 3 / unit;
    if (o.P_star > 0) o.s_dev = seen.sigma.norm() / seen.P;
    const Deviator<double> N = shear_direction(resolve(record.path));
    if (N.norm() > 0) {
      if (o.P_star > 0) o.s_par = seen.sigma.dot(N) / seen.P;
      o.F_par = seen.F.dot(N);
    }
    o.mean_overlap = law_.overlap_D * std::max(0.0, std::log(o.nu / law_.isotropic.pressure.nu_c));
    o.E_pot = 1e-3 * seen.P;
    o.E_kin = 1e-4 * o.E_pot;
    o.W_box = o.D_contact = o.D_background = 0;
    o.energy_residual = 1e-7;
    o.inertial_number = 1e-5;
    return o;
  }

  LawParameters<double> law_;
  SyntheticOptions options_;
};

inline std::vector<TestRecord> synthetic_dataset(const LawParameters<double>& law,
                                                 const SyntheticOptions& options = {}) {
  return SyntheticDataset(law, options).records();
}

}  // namespace grainlaw::testing
