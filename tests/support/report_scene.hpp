#pragma once
// A made-up input of the report without DEM and without a fit: series that follow known laws with a seeded ripple.

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "chain/report_input.hpp"
#include "model/reduced_law.hpp"

namespace grainlaw::test {

inline TestRecord make_test(const std::string& name, std::uint64_t seed, double nu,
                            const std::vector<PathSegment>& segments) {
  TestRecord test;
  test.name = name;
  test.path.nu = nu;
  test.path.segments = segments;
  test.packing = {seed, 2000, 3.0, 1e-3, 1e8};
  return test;
}

/// Rows along the path by the closed forms of `p`, `rows` per segment.
inline void fill_rows(TestRecord& test, const LawParameters<double>& p, int rows, std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0.0, 1.0);
  const auto segments = resolve(test.path);
  const Deviator<double> N = shear_direction(segments);
  const auto along = [&](double mean, double deviator_along_N) -> Eigen::Matrix3d {
    return mean * Eigen::Matrix3d::Identity() + tensor_of<double>(deviator_along_N * N);
  };
  double travelled = 0;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    for (int i = s == 0 ? 0 : 1; i <= rows; ++i) {
      const double e = segments[s].length * i / rows;
      Observation row;
      row.segment = static_cast<int>(s);
      row.strain = segments[s].strain(e);
      row.nu = segments[s].nu(e);
      row.eps_vol = row.strain.tensor.trace();
      row.eps_dev = deviatoric_norm(row.strain.tensor);
      row.shear_path = travelled + segments[s].eps_dev_rate() * e;
      row.time = 1e-6 * static_cast<double>(test.rows.size());
      const auto& law = p.isotropic;
      row.C_star = law.coordination.C_star(row.nu) * (1 + 0.003 * noise(generator));
      row.rattler_fraction = law.rattlers.fraction(row.nu, law.coordination.nu_c) * (1 + 0.03 * noise(generator));
      row.C = (1 - row.rattler_fraction) * row.C_star;
      row.P_star = law.P_star(row.nu) * (1 + 0.01 * noise(generator));
      row.F_v = p.fabric_g3 * row.nu * row.C;
      row.mean_overlap = std::max(0.0, p.overlap_D * std::log(row.nu / law.pressure.nu_c));
      if (deviatoric_norm(segments[0].direction.tensor) > 0) {
        row.s_par = reduced_stress_ratio(p, row.nu, 0.01, row.shear_path) + 0.008 * noise(generator);
        row.F_par = reduced_fabric(p, row.nu, 0.005, row.shear_path) + 0.004 * noise(generator);
      }
      const double ratio = N.norm() > 0 ? row.s_par : 0, fabric = N.norm() > 0 ? row.F_par : 0;
      row.stress.tensor = test.packing.stress_unit() * along(row.P_star, ratio * row.P_star);
      row.fabric.tensor = along(row.F_v / 3, fabric);
      row.E_pot = 1e-3 * row.P_star * row.P_star;
      row.E_kin = 1e-6 * row.P_star * std::exp(0.3 * noise(generator));
      if (i > 0) row.energy_residual = 1e-4 * noise(generator);
      if (row.P_star > 0) row.inertial_number = 1e-4 / std::sqrt(row.P_star);
      test.rows.push_back(row);
    }
    travelled += segments[s].eps_dev_rate() * segments[s].length;
  }
}

inline PathSegment segment_of(Mode mode, ExtentKind kind, double extent, bool reverse = false) {
  return {mode, direction_of(mode, "xyz", reverse), kind, extent};
}

inline Estimate estimate_of(double value, double error, Status status = Status::fitted) {
  return {value, error, status, ""};
}

inline fit::ShearFit shear_fit_of(const TestRecord& test, const LawParameters<double>& p, double wobble) {
  fit::ShearFit shear;
  shear.test = test.name;
  shear.seed = test.packing.seed;
  shear.nu = test.path.nu;
  const double nu = shear.nu, c = p.shear_nu_c;
  shear.s_max = estimate_of(p.stress_ratio_max.value(nu, c) * (1 + 0.02 * wobble), 0.004);
  shear.beta_s = estimate_of(p.stress_rate.value(nu, c) * (1 + 0.1 * wobble), 5);
  shear.F_max = estimate_of(p.fabric_max.value(nu, c) * (1 + 0.03 * wobble), 0.003);
  shear.beta_F = estimate_of(p.fabric_rate.value(nu, c) * (1 - 0.1 * wobble), 4);
  shear.s_0 = 0.01;
  shear.F_0 = 0.005;
  shear.s_steady = shear.s_max.value * 1.01;
  shear.F_steady = shear.F_max.value * 0.99;
  shear.eps_dev_max = 0.25;
  shear.C_star = p.steady.coordination.C_star(nu);
  shear.rattler_fraction = p.steady.rattlers.fraction(nu, p.steady.coordination.nu_c);
  shear.P_star = p.steady.P_star(nu);
  return shear;
}

inline predict::Prediction predicted_at(const TestRecord& test, const LawParameters<double>& p, Rung model) {
  predict::Prediction prediction;
  prediction.model = model;
  const double factor = model == Rung::reduced ? 1.0 : 0.95;
  for (const Observation& observed : test.rows) {
    predict::PredictedRow row;
    row.strain = observed.strain;
    row.eps_dev = observed.eps_dev;
    row.eps_vol = observed.eps_vol;
    row.shear_path = observed.shear_path;
    row.nu = observed.nu;
    row.state = {p.isotropic.P_star(row.nu) * factor, Deviator<double>::Zero(), Deviator<double>::Zero()};
    row.s_par = factor * reduced_stress_ratio(p, row.nu, 0.0, row.eps_dev);
    row.F_par = reduced_fabric(p, row.nu, 0.0, row.eps_dev) / factor;
    prediction.rows.push_back(row);
  }
  prediction.statistics = {130, 270, 2, 300, 1, 4.2e-5};
  prediction.warnings = {"nu = 0.82 lies outside the calibrated range 0.68-0.80"};
  return prediction;
}

inline predict::PredictionFolder make_prediction(const std::string& name, double nu, const LawParameters<double>& p,
                                                 std::mt19937_64& generator) {
  predict::PredictionFolder folder;
  folder.name = name;
  folder.dem.emplace();
  for (const std::uint64_t seed : {11u, 12u}) {
    TestRecord test =
        make_test("UNI-seed" + std::to_string(seed), seed, nu, {segment_of(Mode::UNI, ExtentKind::target_nu, 0.82)});
    fill_rows(test, p, 150, generator);
    for (const Rung model : {Rung::reduced, Rung::evolution}) {
      const std::string file = to_string(model) + "-law-seed" + std::to_string(seed) + ".csv";
      folder.curves.push_back({model, predict::Initial::law, seed, file, predicted_at(test, p, model)});
      predict::Comparison comparison{test.name, {}};
      for (const char* quantity : {"P_star", "s_par", "F_par"}) {
        comparison.quantities.push_back({quantity, 300, -0.0012, 0.0034, 0.028, -0.009, 0.12, 0.78});
      }
      folder.comparisons.push_back({model, predict::Initial::law, seed, comparison});
      if (seed == 12) folder.comparisons.push_back({model, predict::Initial::law, std::nullopt, comparison});
    }
    folder.path = test.path;
    folder.dem->tests.push_back({std::move(test), "", "", {}, {}});
  }
  return folder;
}

/// Two seeds, six densities, ISO both branches, D2, D2 then ISO; two predictions. Numbers follow published_parameters().
inline chain::ReportInput report_scene() {
  std::mt19937_64 generator(7);
  const LawParameters<double> p = published_parameters();
  chain::ReportInput input;
  fit::Calibration& c = input.calibration;
  c.law.parameters = p;
  c.law.converged = true;
  c.law.range.nu_min = 0.68;
  c.law.range.nu_max = 0.82;
  c.law.range.eps_dev_max = 0.25;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const double value = *fields(p)[i];
    c.law.estimates[i] = estimate_of(value * 1.01, 0.03 * std::abs(value) + 1e-4);
  }
  c.law.estimates[parameter_index("shear.nu_c")] = estimate_of(0.6653, std::nan(""), Status::fixed);
  c.law.estimates[parameter_index("anisotropy.a0")] = {0, std::nan(""), Status::not_identified,
                                                       "not part of this coupling"};
  fit::Stage evolution;
  evolution.name = "evolution";
  evolution.window = "all calibration trajectories";
  evolution.converged = true;
  evolution.termination = "CONVERGENCE";
  double wobble = 1;
  for (const std::uint64_t seed : {1u, 2u}) {
    const std::string tag = "-seed" + std::to_string(seed);
    TestRecord loading =
        make_test("ISO-loading" + tag, seed, 0.64, {segment_of(Mode::ISO, ExtentKind::target_nu, 0.82)});
    TestRecord unloading =
        make_test("ISO-unloading" + tag, seed, 0.82, {segment_of(Mode::ISO, ExtentKind::target_nu, 0.67, true)});
    for (TestRecord* test : {&loading, &unloading}) {
      fill_rows(*test, p, 200, generator);
      input.tests.push_back(*test);
      input.costs.push_back({120000, 2.3e-8, 12.5});
    }
    evolution.tests.push_back({unloading.name, "P_star", true, 190, 11, 0, 0.0006, 0.0001, 0.1});
    for (const double nu : {0.68, 0.70, 0.72, 0.74, 0.78, 0.80}) {
      const std::string density = std::to_string(nu).substr(0, 5);
      TestRecord shear = make_test("D2-" + density + tag, seed, nu, {segment_of(Mode::D2, ExtentKind::eps_dev, 0.25)});
      TestRecord back = make_test(
          "D2-ISO-" + density + tag, seed, nu,
          {segment_of(Mode::D2, ExtentKind::eps_dev, 0.15), segment_of(Mode::ISO, ExtentKind::target_nu, nu + 0.03),
           segment_of(Mode::ISO, ExtentKind::target_nu, nu, true)});
      for (TestRecord* test : {&shear, &back}) {
        fill_rows(*test, p, 120, generator);
        const double gap = -0.3 * std::exp(-(nu - 0.68) / 0.02);
        evolution.tests.push_back({test->name, "P_star", false, 120, 0, 0, std::abs(gap) * 0.01, gap * 0.01, 0.01});
        evolution.tests.push_back({test->name, "s_par", true, 120, 0, 0, 0.012, 0.002 * wobble, 0.17});
        evolution.tests.push_back({test->name, "F_par", true, 120, 0, 0, 0.006, -0.002 * wobble, 0.12});
        input.tests.push_back(*test);
        input.costs.push_back({90000, 2.3e-8, 8.25});
      }
      c.shear.push_back(shear_fit_of(shear, p, wobble));
      wobble = -wobble;
    }
  }
  fit::Stage density_laws;
  density_laws.name = "stress_ratio_max";
  density_laws.window = "12 tests";
  density_laws.converged = true;
  density_laws.estimates = {{"stress_ratio_max.Q_limit", estimate_of(1.05 * p.stress_ratio_max.Q_limit, 0.004)}};
  c.stages = {density_laws, evolution};
  input.predictions = {make_prediction("uniaxial-0.695", 0.695, p, generator),
                       make_prediction("uniaxial-0.728", 0.728, p, generator)};
  input.provenance = {{"grainlaw", "0.1.0", {"parameters.json"}},
                      {"command", "grainlaw calibrate spec.json -o DIR", {"parameters.json"}}};
  return input;
}

}  // namespace grainlaw::test
