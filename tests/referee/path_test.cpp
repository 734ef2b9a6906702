// LAMMPS and the engine along the same short paths: ISO compression and D2 from relaxed packings, cosine profile, same
// number of steps; P*, s_par and C* at 50 instants.
//
// Mapping. Ours integrates the fluctuation velocity v, m dv/dt = f - gamma_b v, and its contacts see v_ij + L x_ij.
// LAMMPS knows `remap x`, which moves the spheres with the cell and leaves L x_ij out of the contact (gamma L l against
// k delta, 1e-5 of the force at 138 1/s and more than a hundred times the bounds found here), and `remap v`, in which
// spheres carry u = v + L (x - x_c) and feel the cell only when they cross its boundary. With the second,
//   m du/dt = f - gamma_b u + gamma_b L y + m [(dL/dt + L^2) y + L v],   y = x - x_c, v = u - L y
// is our equation exactly; the forces that it adds are given to `fix addforce`. The cell in which the forces of a step are
// computed is set at the end of the step before, so `fix deform` gets the edges of the step to come, and rates of half a
// step before that, where LAMMPS has the velocities.
//
// Bound. With step dt, ours differs from the solution by O(dt^2), LAMMPS, whose damping uses velocities of half a step
// ago, by O(dt). Each is run with dt and dt/2, and by the law of its order its own error at dt is
//   E_LAMMPS = 2 |L(dt) - L(dt/2)|,  E_ours = 4/3 |O(dt) - O(dt/2)|.
// Rounding grows along a path: E_chaos is the largest difference that three perturbations of the positions by 1e-15 of
// the cell make. The two may differ by the sum of the three, each the largest over the path; C* by one contact more, because
// it is a count.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "dem/engine/averages.hpp"
#include "dem/element_tests/element_run.hpp"
#include "dem/element_tests/stepper.hpp"
#include "tests/referee/lammps.hpp"
#include "tests/support/dem_compression.hpp"
#include "tests/support/figure.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::referee {
namespace {

constexpr int kRows = 50;
constexpr double kPeakRate = 138;  // of max(|eps_vol|, eps_dev) [1/s]

struct Row {
  double P_star = 0, s_par = 0, C_star = 0;
};
using Series = std::vector<Row>;

/// A segment with the cosine of Eq. (2) for its z edge, written down here once more for the referee.
struct Course {
  Mode mode = Mode::ISO;
  double z_strain = 0;  ///< ln(z_0/z_f), > 0

  double strain() const { return z_strain * (mode == Mode::ISO ? 3 : std::numbers::sqrt3); }  // larger of the two norms
  double duration() const { return std::numbers::pi / 2 * strain() / kPeakRate; }             // [s]
  /// Powers of z/z_0 that the edges follow.
  Eigen::Vector3d powers() const { return mode == Mode::ISO ? Eigen::Vector3d(1, 1, 1) : Eigen::Vector3d(-1, 0, 1); }
};

Series run_engine(const dem::State& state, const Course& course, int steps) {
  const double nu = dem::volume_fraction(state.packing);
  const StraightSegment segment = dem::scene::segment_of(direction_of(course.mode).tensor, course.z_strain, nu);
  dem::ElementTestOptions options;
  options.engine.precision = dem::Precision::full;
  options.drive.strain_rate = kPeakRate;
  options.engine.time_step_fraction =
      course.duration() / steps / dem::min_collision_time(state.packing, state.material);
  const dem::Drive drive = dem::make_drive(segment, options.drive, state.packing.H);
  const Deviator<double> N = shear_direction({segment});
  Series series;
  const auto test = dem::run_element_test(state, {segment}, options, {}, [&](dem::Stepper& stepper, int, double) {
    dem::Simulation& sim = stepper.simulation();
    if (sim.step() % static_cast<std::uint64_t>(steps / kRows) != 0) return;
    const Observation row = dem::observe(sim, dem::motion_at(drive, sim.time()), N);
    series.push_back({row.P_star, row.s_par, row.C_star});
  });
  EXPECT_EQ(test.steps, static_cast<std::uint64_t>(steps));
  return series;
}

/// Variables of lambda(t) = 1 - depth (1 - cos(pi t/tau))/2, w = (d lambda/dt)/lambda and a = (d^2 lambda/dt^2)/lambda at an
/// instant `offset` steps from LAMMPS's counter.
std::string course_commands(const Course& course, const std::string& instant, double offset) {
  const double half_depth = -std::expm1(-course.z_strain) / 2, frequency = std::numbers::pi / course.duration();
  return fmt::format(
      "variable phase_{0} equal {1:.17g}*(step+({2}))*dt\n"
      "variable lambda_{0} equal 1-{3:.17g}*(1-cos(v_phase_{0}))\n"
      "variable w_{0} equal -{4:.17g}*sin(v_phase_{0})/v_lambda_{0}\n"
      "variable a_{0} equal -{5:.17g}*cos(v_phase_{0})/v_lambda_{0}\n",
      instant, frequency, offset, half_depth, half_depth * frequency, half_depth * frequency * frequency);
}

/// Variables of one axis whose edge is h = h_0 lambda^power: for `fix deform`, which sets the cell of the next step, and
/// the extra force on a sphere of this step, whose velocity is that of half a step ago.
std::string axis_commands(char axis, double edge, double power, double gamma_b) {
  return fmt::format(
      "variable {0}_change equal {1:.17g}*(v_lambda_next^({2})-1)\n"
      "variable {0}_rate equal {1:.17g}*({2})*v_lambda_ahead^({2})*v_w_ahead\n"
      "variable {0}_q equal ({2})*(v_a_now+(({2})-1)*v_w_now^2)\n"  // dL/dt + L^2
      "variable {0}_y atom {0}-{3:.17g}\n"
      "variable {0}_v atom v{0}-({2})*v_w_behind*(v_{0}_y-0.5*dt*v{0})\n"
      "variable {0}_force atom {4:.17g}*({2})*v_w_now*v_{0}_y+mass*(v_{0}_q*v_{0}_y+({2})*v_w_now*v_{0}_v)\n",
      axis, edge, power, edge / 2, gamma_b);
}

Series run_lammps_along(const std::filesystem::path& folder, const dem::State& state, const Course& course, int steps) {
  const dem::Material& material = state.material;
  std::string commands = packing_commands(folder, state, Eigen::Matrix3d::Zero());
  for (const auto& [instant, offset] : {std::pair{"next", 1.0}, {"ahead", 0.5}, {"now", 0.0}, {"behind", -0.5}}) {
    commands += course_commands(course, instant, offset);
  }
  for (int a = 0; a < 3; ++a) {
    commands += axis_commands("xyz"[a], state.packing.H(a, a), course.powers()[a], material.background_viscosity);
  }
  commands += fmt::format(
      "timestep {:.17g}\n"
      "compute sigma all pressure NULL virial\n"
      "compute contacts all contact/atom\n"
      "variable backbone_sphere atom c_contacts>3\n"
      "variable backbone_contacts atom c_contacts*v_backbone_sphere\n"
      "compute backbone all reduce sum v_backbone_sphere v_backbone_contacts\n"
      "fix rows all ave/time {} 1 {} c_sigma[*] c_backbone[*] file rows.txt format ' %.17g'\n"  // before the cell moves on
      "fix cell all deform 1 x variable v_x_change v_x_rate y variable v_y_change v_y_rate z variable v_z_change "
      "v_z_rate "
      "remap v\n"
      "fix drag all viscous {:.17g}\n"
      "fix carried all addforce v_x_force v_y_force v_z_force\n"
      "run {}\n",
      course.duration() / steps, steps / kRows, steps / kRows, material.background_viscosity, steps);
  run_lammps(folder, commands);

  const Deviator<double> N =
      shear_direction({dem::scene::segment_of(direction_of(course.mode).tensor, course.z_strain, 0.7)});
  Series series;
  for (const auto& row : rows_of_numbers(folder / "rows.txt")) {
    if (row.size() != 9 || row[0] == 0) continue;
    Eigen::Matrix3d stress;
    stress << row[1], row[4], row[5], row[4], row[2], row[6], row[5], row[6], row[3];
    const double P = stress.trace() / 3;
    series.push_back({2 * mean_radius(state.packing) / material.stiffness * P, deviator<double>(stress).dot(N) / P,
                      row[8] / row[7]});
  }
  return series;
}

double largest_difference(const Series& a, const Series& b, double Row::*quantity) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    largest = std::max(largest, std::abs(a[i].*quantity - b[i].*quantity));
  }
  return largest;
}

/// The packing with each coordinate moved by 1e-15 of the cell at random.
dem::State perturbed(dem::State state, std::uint64_t seed) {
  dem::scene::Draw draw(seed);
  dem::Packing& p = state.packing;
  for (std::size_t i = 0; i < p.size(); ++i) {
    dem::scene::place(p, i, dem::scene::fraction(p, i) + draw.vector(-1e-15, 1e-15));
  }
  return state;
}

class PathBesideLammps : public testing::TemporaryFolder {
 protected:
  void compare(const std::string& name, const Course& course, double nu) const {
    const dem::State state = dem::scene::jammed({"Paper", 3, 0}, 500, nu, 7);
    const double dt = 0.1 * dem::min_collision_time(state.packing, state.material);
    const int steps = kRows * static_cast<int>(std::ceil(course.duration() / dt / kRows));

    const Series ours = run_engine(state, course, steps), ours_fine = run_engine(state, course, 2 * steps);
    std::vector<Series> shaken;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) shaken.push_back(run_engine(perturbed(state, seed), course, steps));
    const Series theirs = run_lammps_along(folder_, state, course, steps);
    const Series theirs_fine = run_lammps_along(folder_, state, course, 2 * steps);
    ASSERT_EQ(ours.size(), static_cast<std::size_t>(kRows));
    ASSERT_EQ(theirs.size(), ours.size());

    const auto judge = [&](const char* label, double Row::*quantity, double grain = 0) {
      double E_chaos = 0;
      for (const Series& other : shaken) E_chaos = std::max(E_chaos, largest_difference(other, ours, quantity));
      const double E_ours = 4.0 / 3 * largest_difference(ours, ours_fine, quantity);
      const double E_LAMMPS = 2 * largest_difference(theirs, theirs_fine, quantity);
      fmt::print("{} {}: E_LAMMPS {:.2e}, E_ours {:.2e}, E_chaos {:.2e}, at the end of the path {:.6g}\n", name, label,
                 E_LAMMPS, E_ours, E_chaos, ours.back().*quantity);
      testing::expect_figure(fmt::format("LAMMPS.{}.{}", label, name), largest_difference(theirs, ours, quantity),
                             E_LAMMPS + E_ours + E_chaos + grain);
    };
    judge("P_star", &Row::P_star);
    judge("C_star", &Row::C_star, 2.0 / static_cast<double>(state.packing.size()));
    if (course.mode != Mode::ISO) judge("s_par", &Row::s_par);
  }
};

TEST_F(PathBesideLammps, IsotropicCompression) {
  if (const std::string why = lammps_missing(); !why.empty()) GTEST_SKIP() << why;
  compare("ISO_0.82", {Mode::ISO, 0.002}, 0.82);
}

TEST_F(PathBesideLammps, Shear) {
  if (const std::string why = lammps_missing(); !why.empty()) GTEST_SKIP() << why;
  compare("D2_0.82", {Mode::D2, 0.004}, 0.82);
}

TEST_F(PathBesideLammps, ShearNearJamming) {
  if (const std::string why = lammps_missing(); !why.empty()) GTEST_SKIP() << why;
  compare("D2_0.70", {Mode::D2, 0.002}, 0.70);
}

}  // namespace
}  // namespace grainlaw::referee
