#include "dem/lammps/deck.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace grainlaw::dem {
namespace {

constexpr double kTangential = 2.0 / 7;  // of stiffness and viscosity, over those along the normal
constexpr double kSkin = 0.1;            // of the neighbour list over <r>: the fastest here
constexpr double kRestDrag = 0.03;       // over sqrt(k m): soft modes stay underdamped

/// K of Hertz's force K sqrt(r_ij delta) delta [Pa].
double hertz_stiffness(const DeckSpheres& s) { return s.material.stiffness / (2 * s.mean_radius); }

std::string pair_coefficients(const DeckSpheres& s) {
  const double k = s.material.stiffness, gamma = s.material.contact_viscosity;
  const ContactModel& c = s.contacts;
  const bool hertz = c.normal_force == NormalForce::hertz;
  std::string text = "pair_coeff * *";
  if (!hertz)
    text += fmt::format(" hooke {} {}", k, gamma);
  else if (c.cohesion == 0)
    text += fmt::format(" hertz {} {}", hertz_stiffness(s), gamma);
  else  // K = 4/3 E/2 of Young's modulus E, without lateral contraction
    text += fmt::format(" dmt {} {} 0 {}", 1.5 * hertz_stiffness(s), gamma, c.cohesion);
  if (c.friction == 0)
    text += " tangential linear_nohistory 0 0";
  else if (!hertz)
    text += fmt::format(" tangential linear_history {} {} {}", kTangential * k, kTangential, c.friction);
  else
    text +=
        fmt::format(" tangential mindlin {} {} {}", kTangential * 1.5 * hertz_stiffness(s), kTangential, c.friction);
  if (c.rolling_friction > 0)
    text += fmt::format(" rolling sds {} {} {}", kTangential * k, kTangential * gamma, c.rolling_friction);
  return text + " damping velocity\n";
}

std::string head(const std::string& read, const DeckSpheres& s) {
  return "units si\natom_style sphere\nboundary p p p\nnewton off\n" + read +
         "comm_modify vel yes\npair_style granular\n" + pair_coefficients(s) +
         fmt::format("neighbor {} bin\nneigh_modify delay 0 every 1 check yes\n", kSkin * s.mean_radius) +
         fmt::format("fix motion all nve/sphere\nfix drag all viscous {}\n", s.material.background_viscosity) +
         "compute pair all property/local patom1 patom2 cutoff radius\n"
         "compute contact all pair/local fx fy fz p1 p2 p3 p10 p11 p12 cutoff radius\n"
         "compute sigma all pressure NULL virial\n"
         "thermo_style custom step c_sigma[1] c_sigma[2] c_sigma[3]\n"
         "thermo_modify lost error\nthermo 0\n";
}

}  // namespace

std::string deck_of_data(const std::string& file, const DeckSpheres& spheres) {
  return head(fmt::format("read_data {}\n", file), spheres);
}

std::string deck_of_restart(const std::string& file, bool fresh, const DeckSpheres& spheres) {
  return head(fmt::format("read_restart {}\n{}", file, fresh ? "reset_timestep 0\n" : ""), spheres);
}

std::string deck_drive(const std::string& name, const Drive& drive, std::uint64_t steps, std::uint64_t begin) {
  const Eigen::Vector3d D = drive.segment.direction.tensor.diagonal();
  const double n = static_cast<double>(steps), length = drive.segment.length;
  std::string text = fmt::format("timestep {}\nvariable n equal step-{}\n", drive.duration / n, begin);
  if (drive.options.profile == Profile::constant) {
    text += fmt::format("variable e equal {}*v_n/{}\nvariable rate equal {}\n", length, steps, length / drive.duration);
  } else {
    const double leading = leading_rate(drive.segment.direction.tensor);
    text += fmt::format(
        "variable z equal 1+({0})*(1-cos(PI*v_n/{1}))/2\n"
        "variable e equal ln(v_z)/({2})\n"
        "variable rate equal ({0})*sin(PI*v_n/{1})*{3}/(v_z*({2}))\n",
        std::expm1(leading * length), steps, leading, std::numbers::pi / (2 * drive.duration));
  }
  std::string fix = fmt::format("fix {} all deform 1", name);
  for (int a = 0; a < 3; ++a) {
    if (D[a] == 0) continue;
    const char axis = "xyz"[a];
    text += fmt::format(
        "variable d{0} equal {1}*exp(({2})*v_e)-$(l{0}:%.17g)\n"
        "variable r{0} equal {1}*({2})*exp(({2})*v_e)*v_rate\n",
        axis, drive.H_0(a, a), D[a]);
    fix += fmt::format(" {0} variable v_d{0} v_r{0}", axis);
  }
  return text + fix + " remap x\n";
}

std::string deck_end_of_drive(const std::string& name) { return fmt::format("unfix {}\n", name); }

std::string deck_run(std::uint64_t from, std::uint64_t to, std::uint64_t fixed, std::uint64_t end) {
  return fmt::format("run {} start {} stop {} post no\n", to - from, fixed, end);
}

std::string deck_look(const std::string& name) {
  // `run 0`: the cell has moved on since the last forces, and images have not followed
  return fmt::format(
      "dump spheres all custom 1 {0}.spheres id x y z radius vx vy vz\n"
      "dump_modify spheres sort id first yes format float %.17g\n"
      "dump contacts all local 1 {0}.contacts c_pair[1] c_pair[2] c_contact[1] c_contact[2] c_contact[3] c_contact[4] "
      "c_contact[5] c_contact[6] c_contact[7] c_contact[8] c_contact[9]\n"
      "dump_modify contacts first yes format float %.17g\n"
      "run 0 post no\n"
      "variable sigma string \"$(c_sigma[1]:%.17g) $(c_sigma[2]:%.17g) $(c_sigma[3]:%.17g)\"\n"
      "undump spheres\n"
      "undump contacts\n"
      "write_restart {0}.restart\n"
      "print \"{0} ${{sigma}}\" append marks screen no\n",
      name);
}

std::string deck_keep(const std::string& file) {
  return fmt::format("run 0 post no\nwrite_restart {0}\nprint \"{0}\" append marks screen no\n", file);
}

std::string deck_relaxation(double volume, std::uint64_t steps, double time_step, const DeckSpheres& s) {
  const double drag = kRestDrag * std::sqrt(s.material.stiffness * sphere_mass(s.material, s.mean_radius));
  return fmt::format(
      "run 0 post no\n"  // before it, the springs of a restart file are not with their contacts, and no cell may change
      "variable scale equal $(({0}/vol)^(1/3):%.17g)\n"
      "change_box all x scale ${{scale}} y scale ${{scale}} z scale ${{scale}} remap\n"
      "timestep {1}\n"
      "fix rest all viscous {2}\n"
      "run {3} post no\n"
      "unfix rest\n"
      "velocity all set 0 0 0\n"
      "set group all omega 0 0 0\n",
      volume, time_step, drag, steps);
}

}  // namespace grainlaw::dem
