#include "dem/foreign/particle_series.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "dem/engine/averages.hpp"
#include "dem/foreign/frame.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kUpright = 1e-9;         // of the stretch: shear of the cell that is rounding
constexpr double kSameRadius = 1e-5;      // relative; dumps have six digits
constexpr double kUnequalMoments = 0.01;  // antisymmetric over symmetric stress that is worth a word

class SeriesOfFrames {
 public:
  SeriesOfFrames(const ParticleRequest& request, const RunControl& control)
      : request_(request), control_(control), frames_(request) {}

  ParticleSeries read() {
    Frame before, now, after;
    bool more = frames_.next(now);
    if (!more) throw InvalidInput(fmt::format("{}: files: hold no frames", request_.where));
    H_0_ = now.packing.H;
    for (std::size_t count = 0; more; ++count) {
      check_same_spheres(now, count);
      more = frames_.next(after);
      add(now, gradient(count > 0 ? before : now, more ? after : now));
      before = std::move(now);
      now = std::move(after);
      if (control_.stop.stop_requested()) throw Interrupted("interrupted while frames were read");
    }
    say();
    return std::move(series_);
  }

 private:
  Eigen::Matrix3d stretch(const Eigen::Matrix3d& H) const { return H * H_0_.inverse(); }

  static bool upright(const Eigen::Matrix3d& F) {
    return (F - Eigen::Matrix3d(F.diagonal().asDiagonal())).cwiseAbs().maxCoeff() <= kUpright;
  }

  Eigen::Matrix3d gradient(const Frame& from, const Frame& to) const {
    const double dt = to.time - from.time;
    if (!(dt > 0)) return Eigen::Matrix3d::Zero();
    const Eigen::Vector3d rate =
        (stretch(to.packing.H).diagonal().array() / stretch(from.packing.H).diagonal().array()).log() / dt;
    return rate.asDiagonal();
  }

  void check_same_spheres(const Frame& frame, std::size_t count) {
    const Packing& p = frame.packing;
    if (count == 0) {
      ids_ = p.id;
      radii_ = p.radius;
      series_.packing.particles = static_cast<std::int64_t>(p.size());
      series_.packing.mean_radius = mean_radius(p);
      series_.packing.stiffness = request_.stiffness;
      return;
    }
    if (p.id != ids_)
      throw frame.source.refusal("does not have the spheres of the first frame; give all in every frame");
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (std::abs(p.radius[i] - radii_[i]) > kSameRadius * radii_[i])
        throw frame.source.refusal(fmt::format(
            "sphere {} has another radius than in the first frame; ids must name the same sphere in all", p.id[i]));
    }
  }

  void add(const Frame& frame, const Eigen::Matrix3d& L) {
    const Packing& p = frame.packing;
    Observation row;
    row.time = frame.time;
    set_averages(row, request_.contacts ? given(frame) : by_law(frame, L, row), p, request_.stiffness,
                 Deviator<double>::Zero(), false);
    const double P = row.stress.tensor.trace() / 3;
    if (!std::isnan(request_.density)) {
      if (frame.has_velocities) {
        row.stress_kinetic.tensor = kinetic_stress(p);
        row.E_kin = kinetic_energy(p);
      }
      if (!L.isZero(0)) row.inertial_number = inertial_number(L, P, mean_radius(p), request_.density);
    }
    set_path(row, stretch(p.H), frame.source);
    series_.rows.push_back(row);
    series_.places.push_back(frame.source.where());
  }

  ContactSums given(const Frame& frame) {
    try {
      const GivenSums given = sum_given(frame.packing, frame.contacts);
      listed_twice_ = given.listed_twice;
      antisymmetry_ = std::max(antisymmetry_, given.antisymmetry);
      unbalanced_ = std::max(unbalanced_, given.unbalanced);
      return given.sums;
    } catch (const InvalidInput& error) {
      throw frame.contacts_source.refusal(error.what());
    }
  }

  ContactSums by_law(const Frame& frame, const Eigen::Matrix3d& L, Observation& row) {
    if (request_.contact_viscosity != 0 && !frame.has_velocities)
      throw frame.source.refusal("contact_viscosity needs velocities vx, vy, vz; dump them, or remove the key");
    State state;
    state.material.stiffness = request_.stiffness;
    state.material.contact_viscosity = request_.contact_viscosity;
    state.packing = frame.packing;
    ThreadTeam team(1);
    const CellMotion motion{frame.packing.H, L, Transport::homogeneous};
    try {
      const auto view = view_contacts(state, build_list(state.packing, 0, team), motion);
      const ContactSums sums = sum_contacts(view->field, state.packing.radius, team);
      row.E_pot = sums.elastic;
      return sums;
    } catch (const Error& error) {
      throw frame.source.refusal(error.what());
    }
  }

  void set_path(Observation& row, const Eigen::Matrix3d& F, const ForeignFrame& frame) {
    if (!series_.sheared && !upright(F))
      series_.sheared = frame
                            .refusal(
                                "the cell shears or turns against that of the first frame; strains are read of cells "
                                "that deform along their axes only")
                            .what();
    row.shear_path = Observation::undefined;
    if (series_.sheared) {
      row.strain.tensor.setConstant(Observation::undefined);
      return;
    }
    Strain strain;
    strain.tensor = Eigen::Vector3d(F.diagonal().array().log()).asDiagonal();
    set_strain(row, strain);
    const Eigen::Matrix3d step =
        series_.rows.empty() ? strain.tensor : strain.tensor - series_.rows.back().strain.tensor;
    row.shear_path = (series_.rows.empty() ? 0 : series_.rows.back().shear_path) + deviatoric_norm(step);
  }

  void say() {
    std::vector<std::string>& notes = series_.notes;
    const std::size_t frames = series_.rows.size();
    notes.push_back(fmt::format("{} frame{} of {} spheres", frames, frames == 1 ? "" : "s", series_.packing.particles));
    if (!request_.contacts) {
      notes.push_back(request_.contact_viscosity == 0
                          ? "forces by the declared law, elastic: k times the overlap"
                          : "forces by the declared law: k times the overlap and gamma times its rate");
      return;
    }
    notes.push_back(fmt::format("forces as given, each contact listed {}", listed_twice_ ? "twice" : "once"));
    notes.push_back(
        fmt::format("stress symmetrised; its antisymmetric part was {:.2g} of it at most{}", antisymmetry_,
                    antisymmetry_ > kUnequalMoments ? ": spheres are not in balance, or forces are mixed up" : ""));
    notes.push_back(
        fmt::format("mean net force on a sphere over mean force of a contact: {:.2g} at most", unbalanced_));
  }

  const ParticleRequest& request_;
  const RunControl& control_;
  Frames frames_;
  Eigen::Matrix3d H_0_;
  std::vector<std::int64_t> ids_;
  std::vector<double> radii_;
  ParticleSeries series_;
  bool listed_twice_ = false;
  double antisymmetry_ = 0, unbalanced_ = 0;
};

}  // namespace

ParticleSeries read_particles(const ParticleRequest& request, const RunControl& control) {
  return SeriesOfFrames(request, control).read();
}

}  // namespace grainlaw::dem
