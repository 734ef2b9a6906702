#pragma once
// Hard case F2: how often the 95 % interval, value +- 1.96 standard errors, contains the truth. White noise of a given size
// on every measured quantity of every row but the first of a test (which is the start that the model is given):
//   P*, C*, phi_r, <delta>/<r>, F_v: relative to the value;  sigma'/P and F': of their largest norm in the test
// fresh data of the same truth each time.

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <random>
#include <string>

#include "fit/density_fit.hpp"
#include "fit/evolution_fit.hpp"
#include "tests/support/synthetic_dataset.hpp"

namespace grainlaw::testing {

/// Parameters whose limits of Eq. (20) lie inside their bounds: an interval around a bound is none.
inline LawParameters<double> interior_truth() {
  LawParameters<double> p = synthetic_truth();
  p.fabric_max = {0.03, 0.14, 6};
  p.fabric_rate = {10, 48, 8};
  return p;
}

class WhiteNoise {
 public:
  WhiteNoise(double size, std::uint64_t seed) : size_(size), engine_(seed) {}

  double factor() { return 1 + size_ * normal_(engine_); }

  Deviator<double> vector(double scale) {
    Deviator<double> v;
    for (int i = 0; i < 5; ++i) v(i) = size_ * scale * normal_(engine_);
    return v;
  }

  void add_to(TestRecord& test) {
    const Deviator<double> N = shear_direction(resolve(test.path));
    double s_scale = 0, F_scale = 0;
    for (const Observation& row : test.rows) {
      if (row.P_star > 0) s_scale = std::max(s_scale, row.s_dev);
      F_scale = std::max(F_scale, row.F_dev);
    }
    for (std::size_t i = 1; i < test.rows.size(); ++i) {
      Observation& row = test.rows[i];
      const double P = row.stress.tensor.trace() / 3;
      const Deviator<double> q = deviator<double>(row.stress.tensor) / (P > 0 ? P : 1) + vector(s_scale);
      const Deviator<double> F = deviator<double>(row.fabric.tensor) + vector(F_scale);
      const double f = factor();
      row.stress.tensor = P * f * (Eigen::Matrix3d::Identity() + tensor_of(q));
      row.P_star *= f;
      row.F_v *= factor();
      row.fabric.tensor = tensor_of(F) + row.F_v / 3 * Eigen::Matrix3d::Identity();
      row.C_star *= factor();
      row.rattler_fraction *= factor();
      row.mean_overlap *= factor();
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
  double size_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

class Coverage {
 public:
  void add(const std::vector<fit::NamedEstimate>& estimates, const LawParameters<double>& truth) {
    for (const fit::NamedEstimate& e : estimates) {
      Count& count = counts_[e.name];
      ++count.sets;
      const double error = e.estimate.standard_error;
      if (e.estimate.status != fit::Status::fitted || !std::isfinite(error)) continue;
      ++count.intervals;
      const double off = e.estimate.value - *fields(truth)[parameter_index(e.name)];
      count.inside += std::abs(off) <= 1.96 * error;
      count.z2 += off * off / (error * error);
    }
  }

  struct Count {
    int sets = 0, intervals = 0, inside = 0;
    double z2 = 0;  // sum of (off/error)^2
    double coverage() const { return static_cast<double>(inside) / intervals; }
  };
  const std::map<std::string, Count>& counts() const { return counts_; }

 private:
  std::map<std::string, Count> counts_;
};

}  // namespace grainlaw::testing
