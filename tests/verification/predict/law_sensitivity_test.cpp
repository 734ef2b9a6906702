// What the parameters change of a prediction: CVODES' forward sensitivities beside closed forms, and beside differences
// of whole predictions with changed parameters, which know nothing of sensitivities, corners or events.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "predict/predict.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/law_path.hpp"

namespace grainlaw::predict {
namespace {

using testing::expect_figure;
using testing::leg;
using testing::leg_to;
using testing::path_from;

constexpr Tolerances kTight{1e-13, 1e-17};

/// With a memory, and nothing at zero but what is meant to be.
LawParameters<double> law_with_memory() {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a2 = 1.18;
  p.memory = {0.8, 0.7, 2.5, 10, 45, 9, 1.0, 0.7, 0.6, 1.18};
  p.lode = {0.05, 0.8};  // no row of the paths below stands where s_dev = 0, which has a kink there
  return p;
}

std::vector<std::size_t> all_parameters() {
  std::vector<std::size_t> all(kParameterCount);
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

constexpr std::size_t kOutputs = 17;
constexpr double kFromJamming = 0.03;  // the least distance of the paths from it

/// What a row reports, tensor components included.
std::vector<double> outputs(const LawState<double>& state, double s_dev, double s_par, double F_dev, double F_par) {
  std::vector<double> out{state.P, s_dev, s_par, F_dev, F_par};
  const Eigen::Matrix3d sigma = tensor_of(state.sigma), F = tensor_of(state.F);
  for (const auto& [i, j] : kComponentIndex) {
    out.push_back(sigma(i, j));
    out.push_back(F(i, j));
  }
  return out;
}
std::vector<double> outputs(const PredictedRow& row) {
  return outputs(row.state, row.s_dev, row.s_par, row.F_dev, row.F_par);
}
std::vector<double> outputs(const RowSlope& slope) {
  return outputs(slope.state, slope.s_dev, slope.s_par, slope.F_dev, slope.F_par);
}

using Slopes = std::vector<std::vector<RowSlope>>;  // [row][k]

/// Of all rows to `parameters`, into `slopes`.
Sensitivity kept(Slopes& slopes, const std::vector<std::size_t>& parameters, bool start_from_law = true) {
  return {parameters, start_from_law,
          [&](const PredictedRow&, const std::vector<RowSlope>& of_row) { slopes.push_back(of_row); }};
}

struct Case {
  Rung rung;
  Coupling coupling;
  std::vector<StraightSegment> path;
  bool start_from_law = true;
};

LawState<double> measured_start() {
  LawState<double> start{0.017, Deviator<double>::Zero(), Deviator<double>::Zero()};
  start.sigma << 2e-4, -1e-4, 1e-4, 3e-4, -1e-4;
  start.F << 0.01, 0.004, -0.003, 0.002, 0.001;
  return start;
}

Prediction run(const Case& c, const LawParameters<double>& p, const Sensitivity& sensitivity = {}) {
  const LawState<double> start = c.start_from_law ? state_from_law(p, c.path.front().nu_start) : measured_start();
  return predict(c.rung, p, c.coupling, c.path, start, uniform_points(c.path, 12), kTight, {}, {}, sensitivity);
}

/// Largest |slope - difference| over the largest |difference| of the same output and parameter on the path; elasticities
/// below 0.01 (of P for stresses, of 0.1 for ratios and fabric) count as that.
double farthest(const Case& c) {
  const LawParameters<double> p = law_with_memory();
  Slopes slopes;
  const Prediction prediction = run(c, p, kept(slopes, all_parameters(), c.start_from_law));
  double worst = 0;
  for (std::size_t k = 0; k < kParameterCount; ++k) {
    const bool density = std::string(parameter_table()[k].name).ends_with("nu_c");
    const double magnitude = density ? kFromJamming : std::max(std::abs(*fields(p)[k]), 0.01);
    const double h = 1e-3 * magnitude;
    // f' = [45 (f_1 - f_-1) - 9 (f_2 - f_-2) + (f_3 - f_-3)]/(60 h), off by h^6 f'/140
    std::vector<std::vector<double>> difference(prediction.rows.size(), std::vector<double>(kOutputs));
    for (const auto& [n, weight] : {std::pair{1, 45.}, {2, -9.}, {3, 1.}}) {
      LawParameters<double> above = p, below = p;
      *fields(above)[k] += n * h;
      *fields(below)[k] -= n * h;
      const Prediction up = run(c, above), down = run(c, below);
      for (std::size_t i = 0; i < up.rows.size(); ++i) {
        const auto high = outputs(up.rows[i]), low = outputs(down.rows[i]);
        for (std::size_t q = 0; q < kOutputs; ++q) difference[i][q] += weight * (high[q] - low[q]) / (60 * h);
      }
    }
    for (std::size_t q = 0; q < kOutputs; ++q) {
      const double typical = q == 0 || (q > 4 && q % 2 == 1) ? prediction.rows[0].state.P : 0.1;
      double scale = 0.01 * typical / magnitude, off = 0;
      for (std::size_t i = 0; i < difference.size(); ++i) {
        scale = std::max(scale, std::abs(difference[i][q]));
        const double here = std::abs(outputs(slopes[i][k])[q] - difference[i][q]);
        if (!(here <= off)) off = here;  // what is no number does not pass
      }
      if (!(off / scale <= worst)) worst = off / scale;
    }
  }
  return worst;
}

std::vector<StraightSegment> uniaxial() { return path_from(0.70, {leg_to(Mode::UNI, 0.80)}); }
std::vector<StraightSegment> reversal() {
  return path_from(0.70, {leg(Mode::D2, 0.1), leg(Mode::D2, 0.16, true), leg(Mode::D2, 0.05)});
}
std::vector<StraightSegment> volume_after_shear() {
  return path_from(0.70, {leg(Mode::D3, 0.06), leg_to(Mode::ISO, 0.73), leg_to(Mode::UNI, 0.71, true)});
}

/// The state turns about y by two thirds of a right angle while x and z are sheared: faster than shear can follow, and
/// s_r follows s. Then it is sheared at 110 degrees.
std::vector<StraightSegment> turning() {
  std::vector<StraightSegment> path = path_from(0.72, {leg(Mode::D2, 0.05), leg(Mode::D2, 0.005), leg(Mode::D3, 0.03)});
  path[1].spin << 0, 0, -400, 0, 0, 0, 400, 0, 0;
  return path;
}

/// Sheared back to no stress, which leaves fabric, and turned twice: there compression takes s down along the fabric faster
/// than a little shear brings it up.
std::vector<StraightSegment> following() {
  std::vector<StraightSegment> path =
      path_from(0.72, {leg(Mode::D2, 0.05), leg(Mode::D2, 0.034, true), leg(Mode::D2, 0.002), leg(Mode::D2, 0.01, true),
                       leg(Mode::D2, 0.02, true)});
  path[3].direction.tensor = 0.02 * path[3].direction.tensor - Eigen::Matrix3d::Identity();
  path[4].nu_start = path[3].nu(path[3].length);
  return path;
}

// The bound is that of the differences: predictions are good to some 1e-11, over a part in a thousand of a parameter.
TEST(Sensitivity, IsTheDifferenceOfPredictions) {
  for (const Rung rung : kRungs) {
    const std::string name = "sensitivity." + to_string(rung) + ".";
    expect_figure(name + "uniaxial", farthest({rung, Coupling::energy, uniaxial()}), 1e-5);
    expect_figure(name + "reversal", farthest({rung, Coupling::energy, reversal()}), 1e-5);
    expect_figure(name + "volume_after_shear", farthest({rung, Coupling::energy, volume_after_shear()}), 1e-5);
    expect_figure(name + "turning", farthest({rung, Coupling::energy, turning()}), 1e-5);
    expect_figure(name + "following", farthest({rung, Coupling::energy, following()}), 1e-5);
    // There the memory rung comes off its limit in expansion: where Delta passes kLeastDistance the rate has a kink, which costs
    // the slopes a part in 1e5 (1.18e-5 at any step of the differences and any tolerance).
    expect_figure(name + "measured_start", farthest({rung, Coupling::energy, volume_after_shear(), false}),
                  rung == Rung::memory ? 2e-5 : 1e-5);
  }
  expect_figure("sensitivity.single.uniaxial", farthest({Rung::evolution, Coupling::single, uniaxial()}), 1e-5);
}

TEST(Sensitivity, GoesOnWhereShearTurnsWithinASegment) {
  for (const auto& [path, segment] : {std::pair{turning(), 1}, {following(), 3}}) {
    Slopes slopes;
    const Prediction prediction =
        run({Rung::memory, Coupling::energy, path}, law_with_memory(), kept(slopes, all_parameters()));
    ASSERT_EQ(slopes.size(), prediction.rows.size());
    std::vector<double> s_r;
    for (const PredictedRow& row : prediction.rows) {
      if (row.segment == segment) s_r.push_back(row.state.s_r.norm());
    }
    EXPECT_GT(std::abs(s_r.back() - s_r.front()), 5e-4) << "turned within the segment";
    for (const auto& of_row : slopes) EXPECT_TRUE(std::isfinite(of_row[0].state.P));
  }
}

TEST(Sensitivity, OfEqs17And18IsTheirs) {
  // with A = 0 at constant volume Eq. (16) is s = s_max (1 - exp(-beta_s e)), F = F_max (1 - exp(-beta_F e))
  LawParameters<double> p = law_with_memory();
  p.anisotropy.a0 = 0;
  const auto path = path_from(0.74, {leg(Mode::D2, 0.2)});
  const auto index = [](const char* name) { return parameter_index(name); };
  Slopes slopes;
  const Sensitivity sensitivity =
      kept(slopes, {index("stress_ratio_max.Q_limit"), index("stress_rate.Q_limit"), index("fabric_max.Q_limit"),
                    index("fabric_rate.Q_limit"), index("pressure.p0")});
  const Prediction prediction = predict(Rung::evolution, p, Coupling::single, path, state_from_law(p, 0.74),
                                        uniform_points(path, 40), {1e-9, 1e-13}, {}, {}, sensitivity);
  const LawModuli<double> m = moduli_at(p, 0.74);
  double off = 0;
  for (std::size_t i = 0; i < prediction.rows.size(); ++i) {
    const double e = prediction.rows[i].shear_path, s = std::exp(-m.beta_s * e), F = std::exp(-m.beta_F * e);
    const auto& slope = slopes[i];
    const auto differs = [&](double found, double expected, double largest) {
      const double here = std::abs(found - expected) / largest;
      if (!(here <= off)) off = here;
    };
    differs(slope[0].s_par, 1 - s, 1);
    differs(slope[1].s_par, m.s_max * e * s, m.s_max / m.beta_s);
    differs(slope[2].F_par, 1 - F, 1);
    differs(slope[3].F_par, m.F_max * e * F, m.F_max / m.beta_F);
    differs(slope[4].state.P, m.P_iso / p.isotropic.pressure.p0, 1);
    differs(slope[4].s_dev, 0, 1);
  }
  expect_figure("sensitivity.closed_form", off, 2e-8);
}

// Two runs that may be off by ten tolerances each (hard case O1).
TEST(Sensitivity, LeavesTheRowsAsTheyAre) {
  double off = 0;
  for (const Rung rung : kRungs) {
    const Case c{rung, Coupling::energy, reversal()};
    Slopes slopes;
    const Prediction without = run(c, law_with_memory()),
                     with = run(c, law_with_memory(), kept(slopes, all_parameters()));
    ASSERT_EQ(slopes.size(), with.rows.size());
    for (std::size_t i = 0; i < with.rows.size(); ++i) {
      const LawState<double>&a = with.rows[i].state, &b = without.rows[i].state;
      off = std::max({off, std::abs(a.P / b.P - 1), (a.sigma - b.sigma).norm() / b.P, (a.F - b.F).norm()});
    }
  }
  expect_figure("sensitivity.rows_changed", off, 20 * kTight.relative);
}

TEST(Sensitivity, EndsWhereTheStateUnjams) {
  const auto path = path_from(0.70, {leg(Mode::D2, 0.05), leg_to(Mode::ISO, 0.63, true), leg_to(Mode::ISO, 0.72)});
  for (const Rung rung : kRungs) {
    Slopes slopes;
    const Prediction prediction =
        run({rung, Coupling::energy, path}, law_with_memory(), kept(slopes, all_parameters()));
    ASSERT_TRUE(prediction.unjammed);
    ASSERT_EQ(slopes.size(), prediction.rows.size());
    bool jammed = true;
    for (std::size_t i = 0; i < prediction.rows.size(); ++i) {
      jammed = jammed && prediction.rows[i].state.P > 0;
      for (const RowSlope& slope : slopes[i])
        EXPECT_EQ(std::isfinite(slope.state.P), jammed) << to_string(rung) << " row " << i;
    }
    EXPECT_GT(prediction.rows.back().state.P, 0) << "jammed again, which is not followed";
  }
}

TEST(Sensitivity, IsThatOfTheImplicitMethodToo) {
  const LawParameters<double> p = law_with_memory();
  const auto path = reversal();
  Tolerances tolerances{1e-10, 1e-14};
  const auto at_the_end = [&](Method method) {
    tolerances.method = method;
    Slopes slopes;
    predict(Rung::memory, p, Coupling::energy, path, state_from_law(p, 0.70), uniform_points(path, 5), tolerances, {},
            {}, kept(slopes, all_parameters()));
    return slopes.back();
  };
  const auto adams = at_the_end(Method::adams), bdf = at_the_end(Method::bdf);
  double off = 0;
  for (std::size_t k = 0; k < kParameterCount; ++k) {
    const double scale = std::max(adams[k].state.sigma.norm(), 1e-4 / std::max(1e-2, std::abs(*fields(p)[k])));
    off = std::max(off, (adams[k].state.sigma - bdf[k].state.sigma).norm() / scale);
  }
  expect_figure("sensitivity.bdf_beside_adams", off, 1e-6);
}

}  // namespace
}  // namespace grainlaw::predict
