// D9 in production, D16, D25: what a run must say of itself, and when it must stop.
//   residual of a row    (W - dE_pot - dE_kin - D)/(|W| + E_kin(0) + D), always in the series
//   judged residual      |W - dE_pot - dE_kin - D|/(largest |W| of the rows so far + E_kin(0) + D); 0 while the numerator
//                        is what adding up energies loses by rounding; warning beyond 1e-3, stop beyond 1e-2
//   inertial number      I = rate d sqrt(rho/P),  rate = max(|eps_vol rate|, eps_dev rate), d = 2<r>; warning beyond 1e-3
// The formulas are written here once more, on the columns of the rows alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <optional>

#include "dem/element_tests/element_run.hpp"
#include "model/vocabulary/error.hpp"
#include "tests/support/dem_compression.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::dem {
namespace {

using scene::Family;
using testing::expect_figure;

using Rows = std::vector<Observation>;

std::vector<StraightSegment> path_of(const State& state, const std::vector<PathSegment>& segments) {
  return resolve({volume_fraction(state.packing), Branch::unloading, segments});
}

PathSegment segment(Mode mode, double extent, bool reverse = false) {
  const bool volumetric = mode == Mode::ISO || mode == Mode::UNI;
  return {mode, direction_of(mode, "xyz", reverse), volumetric ? ExtentKind::eps_vol : ExtentKind::eps_dev, extent};
}

ElementTestOptions options_of(double time_step_fraction, double strain_rate, int rows) {
  ElementTestOptions options;
  options.engine = scene::engine_options();
  options.engine.time_step_fraction = time_step_fraction;
  options.check_time_step = false;
  options.drive.strain_rate = strain_rate;
  options.rows = rows;
  return options;
}

double imbalance(const Rows& rows, std::size_t k) {
  const Observation &first = rows[0], &row = rows[k];
  return row.W_box - (row.E_pot - first.E_pot) - (row.E_kin - first.E_kin) - row.D_contact - row.D_background;
}

double exchanged(const Rows& rows, std::size_t k) { return rows[0].E_kin + rows[k].D_contact + rows[k].D_background; }

std::vector<double> judged_residuals(const Rows& rows) {
  std::vector<double> judged;
  double largest_work = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    largest_work = std::max(largest_work, std::abs(rows[k].W_box));
    const double energies = rows[k].E_pot + rows[k].E_kin + rows[0].E_pot + rows[0].E_kin;
    const double left = std::abs(imbalance(rows, k));
    judged.push_back(left <= 1e-11 * energies ? 0 : left / (largest_work + exchanged(rows, k)));
  }
  return judged;
}

std::size_t first_beyond(const std::vector<double>& values, double limit) {
  const auto beyond = std::find_if(values.begin(), values.end(), [&](double v) { return v > limit; });
  return static_cast<std::size_t>(beyond - values.begin());
}

/// The row at which a run was stopped by its energy balance, 0 when a step was beyond all bounds before the first row;
/// nothing when it went through to its end.
std::optional<std::size_t> row_of_stop(const State& start, const std::vector<StraightSegment>& path,
                                       const ElementTestOptions& options) {
  try {
    run_element_test(start, path, options, {});
  } catch (const InvalidInput& error) {
    ADD_FAILURE() << error.what();
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with("energy balance")) << message;
    if (message.find("crosses more than an eighth of the cell") != std::string::npos) return 0;
    const std::size_t row = message.find(" at row ");
    EXPECT_NE(row, std::string::npos) << message;
    return std::stoul(message.substr(row + 8)) - 1;  // counted from 1
  }
  return std::nullopt;
}

/// Rows that a run's warning about `what` counts; 0 without such a warning.
std::size_t rows_warned_of(const ElementTest& test, const std::string& what) {
  for (const std::string& warning : test.warnings) {
    if (!warning.starts_with(what)) continue;
    const std::size_t in = warning.find(" in ");
    EXPECT_NE(warning.find(fmt::format(" of {} rows", test.rows.size())), std::string::npos) << warning;
    return std::stoul(warning.substr(in + 4));
  }
  return 0;
}

std::size_t count_beyond(const std::vector<double>& values, double limit) {
  return static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [&](double v) { return v > limit; }));
}

TEST(RunSafeguards, D9ProductionReportsWarnsAndStops) {
  double column_error = 0;
  int wrong_stops = 0, wrong_warnings = 0, stopped = 0, warned = 0, silent = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const double nu : {0.68, 0.78}) {
      const State start = scene::jammed({"Paper", 3, 0}, 80, nu, seed);
      const auto path =
          path_of(start, {segment(Mode::D2, 0.01), segment(Mode::ISO, 0.005), segment(Mode::D2, 0.01, true)});
      for (const double fraction : {0.1, 0.2, 0.4, 0.55}) {
        ElementTestOptions options = options_of(fraction, 1000, 25);
        const std::optional<std::size_t> stop = row_of_stop(start, path, options);
        options.stop_energy_residual = 1e300;
        const ElementTest test = run_element_test(start, path, options, {});
        const Rows& rows = test.rows;
        const std::vector<double> judged = judged_residuals(rows);
        const std::size_t expected = first_beyond(judged, 1e-2);
        wrong_stops += stop.value_or(rows.size()) != expected ? 1 : 0;
        stopped += stop ? 1 : 0;
        const std::size_t beyond = count_beyond(judged, 1e-3);
        wrong_warnings += rows_warned_of(test, "energy residual above 0.001") != beyond ? 1 : 0;
        warned += beyond > 0 ? 1 : 0;
        silent += beyond == 0 ? 1 : 0;
        for (std::size_t k = 1; k < rows.size(); ++k) {
          const double scale = std::abs(rows[k].W_box) + exchanged(rows, k);
          const double difference = std::abs(rows[k].energy_residual * scale - imbalance(rows, k));
          const double error = difference / (rows[k].E_pot + rows[k].E_kin + rows[0].E_pot);
          if (!(error <= column_error)) column_error = error;  // a NaN stays
        }
      }
    }
  }
  EXPECT_GT(stopped, 0);
  EXPECT_GT(warned, stopped);
  EXPECT_GT(silent, 0);
  expect_figure("D9.production.residual_not_its_formula", column_error, 1e-13);
  expect_figure("D9.production.wrong_warnings", wrong_warnings, 0);
  expect_figure("D9.production.wrong_stops", wrong_stops, 0);
}

// At the default step a driven, jammed packing passes its own judgement with the line at which a run stops.
TEST(RunSafeguards, D9ProductionAtTheDefaultStep) {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const double nu : {0.70, 0.80}) {
      const State start = scene::jammed({"Paper", 3, 0}, 200, nu, seed);
      ElementTestOptions options;
      options.engine = scene::engine_options();
      options.rows = 50;
      const ElementTest test = run_element_test(start, path_of(start, {segment(Mode::UNI, 0.01)}), options, {});
      const std::vector<double> judged = judged_residuals(test.rows);
      worst = std::max(worst, *std::max_element(judged.begin(), judged.end()));
    }
  }
  expect_figure("D9.production.default_step", worst, 1e-2);
}

/// Pressure of a series at a shear path, linear between rows.
double pressure_at(const Rows& rows, double shear_path) {
  std::size_t k = 1;
  while (k + 1 < rows.size() && rows[k].shear_path < shear_path) ++k;
  const double part = (shear_path - rows[k - 1].shear_path) / (rows[k].shear_path - rows[k - 1].shear_path);
  return rows[k - 1].P_star + part * (rows[k].P_star - rows[k - 1].P_star);
}

// Constant-volume shear at the default step: the work passes zero, where a scale of the work so far would condemn a run
// that is right: its pressure is that of a run of a fifth of the step.
TEST(RunSafeguards, D9WorkThatPassesZeroDoesNotStopASoundRun) {
  const State start = scene::jammed({"Paper", 3, 0}, 100, 0.78, 11);
  const auto path = path_of(start, {segment(Mode::D2, 0.03)});
  const Rows rows = run_element_test(start, path, options_of(0.1, 1000, 2000), {}).rows;
  const Rows finer = run_element_test(start, path, options_of(0.02, 1000, 2000), {}).rows;
  double naive = 0, difference = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (std::abs(imbalance(rows, k)) > 1e-11 * rows[k].E_pot)
      naive = std::max(naive, std::abs(rows[k].energy_residual));
    difference = std::max(difference, std::abs(rows[k].P_star / pressure_at(finer, rows[k].shear_path) - 1));
  }
  EXPECT_GT(naive, 2e-2) << "the scale that passes zero would have stopped it";
  const std::vector<double> judged = judged_residuals(rows);
  expect_figure("D9.zero_work.judged", *std::max_element(judged.begin(), judged.end()), 1e-2);
  expect_figure("D9.zero_work.pressure_error", difference, 1e-2);
  EXPECT_TRUE(row_of_stop(start, path, options_of(1 / 1.5, 1000, 2000)).has_value())
      << "broken, the same run must stop";
}

// D16: beyond stability a run does not blow up, it goes quietly wrong; so every one must be stopped. The same runs at the
// default step go through. For w = 10 this step is not beyond stability: its lightest spheres hardly ever touch.
TEST(RunSafeguards, D16UnstableRunsAreStopped) {
  int unstable = 0, finished_green = 0, sound = 0, stopped_although_sound = 0;
  const std::vector<std::pair<Family, std::uint64_t>> packings{
      {{"Paper", 3}, 5}, {{"Paper", 3}, 6}, {{"Paper", 3}, 7}, {{"Equal", 1}, 5}};
  for (const auto& [family, seed] : packings) {
    for (const double nu : {0.66, 0.70, 0.76, 0.82}) {
      const State start = scene::jammed(family, 100, nu, seed);
      for (const Mode mode : {Mode::ISO, Mode::UNI, Mode::D2, Mode::D3}) {
        const auto path = path_of(start, {segment(mode, 0.01)});
        for (const double rate : {138.0, 1000.0}) {
          for (const Transport transport : {Transport::homogeneous, Transport::wall}) {
            ElementTestOptions options = options_of(1 / 1.5, rate, 20);
            options.drive.transport = transport;
            finished_green += row_of_stop(start, path, options) ? 0 : 1;
            ++unstable;
          }
        }
        stopped_although_sound += row_of_stop(start, path, options_of(0.1, 1000, 20)) ? 1 : 0;
        ++sound;
      }
    }
  }
  EXPECT_EQ(unstable, 256);
  EXPECT_EQ(sound, 64);
  expect_figure("D16.finished_green_of_256", finished_green, 0);
  expect_figure("D16.stopped_although_sound_of_64", stopped_although_sound, 0);
}

/// I of a row from its definition; the leading edge of the cosine follows z(t) = z_0 + (z_f - z_0)(1 - cos(pi t/tau))/2.
double inertial_number(const Observation& row, const State& start, const StraightSegment& segment, double peak_rate) {
  const Eigen::Matrix3d& D = segment.direction.tensor;
  const double a = D.diagonal().minCoeff();  // rate of the edge that is compressed most
  const double magnitude = std::max(std::abs(D.trace()), deviatoric_norm(D));
  const double tau = std::numbers::pi / 2 * segment.length * magnitude / peak_rate;
  const double z_0 = 1, z_f = std::exp(a * segment.length), phase = std::numbers::pi * row.time / tau;
  const double z = z_0 + (z_f - z_0) * (1 - std::cos(phase)) / 2;
  const double z_rate = (z_f - z_0) / 2 * std::numbers::pi / tau * std::sin(phase);
  const double rate = z_rate / z / a * magnitude;
  const double P = row.stress.tensor.trace() / 3;
  return rate * 2 * mean_radius(start.packing) * std::sqrt(start.material.density / P);
}

TEST(RunSafeguards, D25InertialNumber) {
  double error = 0;
  int wrong_warnings = 0, warned = 0, silent = 0, runs = 0;
  std::size_t unjammed = 0;
  for (const double nu : {0.64, 0.67, 0.72, 0.80}) {
    const State start = scene::jammed({"Paper", 3, 0}, 100, nu, 3);
    for (const Mode mode : {Mode::ISO, Mode::UNI, Mode::D2, Mode::D3}) {
      for (const double rate : {100.0, 2000.0}) {
        const auto path = path_of(start, {segment(mode, 0.01)});
        ElementTestOptions options;
        options.engine = scene::engine_options();
        options.drive.strain_rate = rate;
        options.rows = 40;
        options.stop_energy_residual = 1e300;  // another matter
        const ElementTest test = run_element_test(start, path, options, {});
        std::vector<double> I;
        for (const Observation& row : test.rows) I.push_back(inertial_number(row, start, path[0], rate));
        const double largest = *std::max_element(I.begin(), I.end());
        for (std::size_t k = 0; k < I.size(); ++k) {
          const double difference = std::abs(test.rows[k].inertial_number - I[k]) / largest;
          if (!(difference <= error)) error = difference;
        }
        // below 6 contacts per sphere nothing is rigid, and nothing is said; such rows are of the loosest packings only
        std::vector<double> jammed;
        for (std::size_t k = 0; k < I.size(); ++k) {
          if (test.rows[k].C_star >= 6) jammed.push_back(I[k]);
        }
        unjammed += count_beyond(I, 1e-3) - count_beyond(jammed, 1e-3);
        const std::size_t beyond = count_beyond(jammed, 1e-3);
        wrong_warnings += rows_warned_of(test, "inertial number above 0.001") != beyond ? 1 : 0;
        (beyond > 0 ? warned : silent) += 1;
        ++runs;
      }
    }
  }
  EXPECT_GT(warned, 2);
  EXPECT_GT(silent, 2);
  EXPECT_GT(unjammed, 2U) << "the loosest packings move fast where nothing is jammed";
  expect_figure("D25.error", error, 1e-12);
  expect_figure("D25.wrong_warnings_of_" + std::to_string(runs), wrong_warnings, 0);
}

}  // namespace
}  // namespace grainlaw::dem
