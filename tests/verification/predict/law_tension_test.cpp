// Hard case O9 as far as the law goes: whatever the path, no row carries a tensile pressure. A state that unjams ends the
// rows; Eq. (16) has no rule by which it would jam again, so that a path which compresses again has no rows there.
// And O8 along the same paths: what is unjammed says so, and no row holds what is not a number.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "predict/predict.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_path.hpp"

namespace grainlaw {
namespace {

using predict::Method;

using testing::figure;
using testing::leg;
using testing::leg_to;

LawParameters<double> parameters() {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a2 = 1.18;
  return p;
}

class Random {
 public:
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  std::size_t index(std::size_t count) { return engine_() % count; }

 private:
  std::mt19937_64 engine_{42};
};

/// Shear, unloading past jamming and compression again, in modes and lengths that differ from path to path.
std::vector<StraightSegment> there_and_back(Random& random, double nu) {
  const Mode modes[] = {Mode::UNI, Mode::D2, Mode::D3};
  const Mode volumetric[] = {Mode::ISO, Mode::UNI};
  std::vector<PathSegment> legs{leg(modes[1 + random.index(2)], random.uniform(0.01, 0.2), random.index(2) == 0),
                                leg_to(volumetric[random.index(2)], random.uniform(0.60, 0.67), true),
                                leg(modes[1 + random.index(2)], random.uniform(0.01, 0.2), random.index(2) == 0),
                                leg_to(volumetric[random.index(2)], random.uniform(0.70, 0.80))};
  return testing::path_from(nu, std::move(legs));
}

struct Tally {
  int paths = 0, unjammed = 0, not_numbers = 0, ended_in_silence = 0;
  double most_tensile = 0;  // largest -P of any row
};

Tally walk_random_paths(Rung model) {
  Random random;
  Tally tally;
  const LawParameters<double> p = parameters();
  const predict::Tolerances tolerances;
  for (; tally.paths < 400; ++tally.paths) {
    const double nu = random.uniform(0.675, 0.80);
    const auto path = there_and_back(random, nu);
    LawState<double> start = predict::state_from_law(p, nu);
    start.P *= random.uniform(0.3, 1.5);
    const double s = random.uniform(0, 1.2) * p.stress_ratio_max.value(nu, p.shear_nu_c);
    Deviator<double> direction, of_fabric;
    for (int i = 0; i < 5; ++i) direction(i) = random.uniform(-1, 1), of_fabric(i) = random.uniform(-1, 1);
    start.sigma = direction.normalized() * (s * start.P);
    start.F = of_fabric.normalized() * (random.uniform(0, 1.2) * p.fabric_max.value(nu, p.shear_nu_c));
    predict::Tolerances t = tolerances;
    t.method = random.index(2) == 0 ? Method::adams : Method::bdf;
    const Coupling coupling = random.index(2) == 0 ? Coupling::energy : Coupling::single;
    const auto points = predict::uniform_points(path, 50);
    const auto prediction = predict::predict(model, p, coupling, path, start, points, t, {}, {});
    tally.unjammed += prediction.unjammed;
    tally.ended_in_silence += prediction.rows.size() < points.size() && !prediction.unjammed;
    for (const auto& row : prediction.rows) {
      tally.most_tensile = std::max(tally.most_tensile, -row.state.P);
      const double all = row.state.P + row.state.sigma.sum() + row.state.F.sum() + row.s_dev + row.s_par + row.F_dev +
                         row.F_par + row.nu + row.strain.tensor.sum();
      tally.not_numbers += !std::isfinite(all);
    }
    if (prediction.unjammed) {
      const auto& at = prediction.unjammed_at;
      EXPECT_TRUE(at.segment >= 0 && at.e >= 0 && at.e <= path[static_cast<std::size_t>(at.segment)].length);
      for (std::size_t i = 0; i < prediction.rows.size(); ++i) {
        EXPECT_TRUE(points[i].segment < at.segment || (points[i].segment == at.segment && points[i].e <= at.e));
      }
    }
  }
  return tally;
}

TEST(Tension, O9NoRowIsTensileOnPathsThatUnjamAndCompressAgain) {
  for (const Rung model : {Rung::reduced, Rung::evolution}) {
    const Tally tally = walk_random_paths(model);
    EXPECT_GT(tally.unjammed, 300);
    EXPECT_LT(tally.unjammed, tally.paths);
    figure("O9." + to_string(model) + ".largest_tension", tally.most_tensile, predict::Tolerances{}.absolute);
    figure("O8." + to_string(model) + ".not_numbers", tally.not_numbers, 0);
    figure("O8." + to_string(model) + ".ended_in_silence", tally.ended_in_silence, 0);
  }
}

}  // namespace
}  // namespace grainlaw
