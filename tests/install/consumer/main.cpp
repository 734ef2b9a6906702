// One element test on a tiny packing and one prediction, through the installed headers only. Prints "NAME VALUE".

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dem/element_tests/preparation.hpp"
#include "predict/predict.hpp"

using namespace grainlaw;

namespace {

std::vector<StraightSegment> one_segment(double nu, Mode mode, double eps_dev) {
  return resolve({nu, Branch::unloading, {{mode, direction_of(mode), ExtentKind::eps_dev, eps_dev}}});
}

/// Gas, compression, relaxation: the state kept at `nu`.
dem::State small_packing(double nu, const dem::DriveOptions& drive) {
  dem::PreparationOptions options;
  options.packing.particles = 64;
  options.drive = drive;
  options.keep_unloading = {nu};
  options.rows = 10;
  dem::State kept;
  dem::prepare(
      options,
      {[&](const dem::KeptState& state) { kept = state.state; }, [](Branch, const std::vector<Observation>&) {}, {}},
      {});
  return kept;
}

void shear_grains() {
  dem::ElementTestOptions options;
  options.drive.strain_rate = 5000;
  options.rows = 20;
  const dem::State start = small_packing(0.74, options.drive);
  const auto path = one_segment(dem::volume_fraction(start.packing), Mode::D2, 0.05);
  const dem::ElementTest test = dem::run_element_test(start, path, options, {});
  double residual = 0;
  for (const Observation& row : test.rows) residual = std::max(residual, std::abs(row.energy_residual));
  std::printf("dem.rows %zu\n", test.rows.size());
  std::printf("dem.nu_change %.3g\n", std::abs(test.rows.back().nu - test.rows.front().nu));
  std::printf("dem.eps_dev %.12g\n", test.rows.back().eps_dev);
  std::printf("dem.P_star %.6g\n", test.rows.back().P_star);
  std::printf("dem.s_par %.6g\n", test.rows.back().s_par);
  std::printf("dem.energy_residual %.3g\n", residual);
}

void predict_uniaxial() {
  LawParameters<double> parameters = published_parameters();
  parameters.anisotropy.a2 = 1;
  const auto path = one_segment(0.70, Mode::UNI, 0.05);
  const predict::Prediction prediction =
      predict::predict(Rung::evolution, parameters, Coupling::energy, path, predict::state_from_law(parameters, 0.70),
                       predict::uniform_points(path, 10), {}, {}, {});
  const predict::PredictedRow &first = prediction.rows.front(), &last = prediction.rows.back();
  std::printf("law.rows %zu\n", prediction.rows.size());
  std::printf("law.nu_ratio_log %.12g\n", std::log(last.nu / first.nu));
  std::printf("law.P_star_start %.6g\n", first.state.P);
  std::printf("law.P_star_end %.6g\n", last.state.P);
  std::printf("law.s_par %.6g\n", last.s_par);
  std::printf("law.F_par %.6g\n", last.F_par);
}

}  // namespace

int main() {
  shear_grains();
  predict_uniaxial();
}
