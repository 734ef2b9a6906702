#pragma once
// How the cell moves along one straight segment of a path, Eq. (2).
//   H(t) = exp(e(t) D) H_0,  e in [0, length]
//   cosine:   the most compressed (else most stretched) edge follows z(t) = z_0 + (z_f - z_0)(1 - cos(pi t/tau))/2,
//             the other edges follow from D, so that constant-volume modes keep the volume to rounding
//   constant: e(t) = length t/tau
// tau = (pi/2) g/strain_rate for the cosine, g/strain_rate for the constant rate, with
// g = strain_of(segment): strain_rate is the peak rate. Homogeneous transport: L = de/dt D.
// Wall-driven: edges move, spheres do not, L = 0 inside and their velocity is unchanged when they re-enter.

#include "dem/engine/simulation.hpp"
#include "model/vocabulary/path.hpp"

namespace grainlaw::dem {

enum class Profile { cosine, constant };
constexpr auto names_of(Profile) { return std::array{"cosine", "constant"}; }

struct DriveOptions {
  double strain_rate = 138;  ///< peak of max(|eps_vol rate|, eps_dev rate) along a segment [1/s]
  Profile profile = Profile::cosine;
  Transport transport = Transport::homogeneous;
  double quasi_static_step =
      0;  ///< > 0: no dynamics, but minimised steps of at most this strain (dem/element_tests/stepper.hpp) [-]
};
constexpr auto fields_of(std::type_identity<DriveOptions>) {
  using D = DriveOptions;
  return std::tuple{Field{&D::strain_rate, "strain_rate", "1/s", "", "peak of max(|eps_vol rate|, eps_dev rate)"},
                    Field{&D::quasi_static_step, "quasi_static_step", "", "",
                          "0: dynamics; above: no dynamics, but affine steps of at most this strain, each followed by "
                          "a minimisation of energy"},
                    Field{&D::profile, "driving", "", "", "profile of the strain rate in time"},
                    Field{&D::transport, "transport", "", "", "what moves with the cell: spheres or only its walls"}};
}
static_assert(tells_every_member<DriveOptions>());

struct Drive {
  StraightSegment segment;
  DriveOptions options;
  Eigen::Matrix3d H_0 = Eigen::Matrix3d::Identity();  ///< cell at the start of the segment [m]
  double duration = 0;                                ///< tau [s]
};

/// Throws InvalidInput naming the first segment that the engine cannot follow: it deforms the cell along its axes only.
void check_can_follow(const std::vector<StraightSegment>& segments);

/// max(|eps_vol|, eps_dev) of the whole segment [-].
double strain_of(const StraightSegment& segment);

/// Throws InvalidInput unless D is diagonal and without spin and the strain rate positive and finite.
Drive make_drive(const StraightSegment& segment, const DriveOptions& options, const Eigen::Matrix3d& H_0);

/// exp(e D), of the edges of a cell [-].
Eigen::Vector3d stretch_of(const StraightSegment& segment, double e);

/// Rate of the edge that the cosine prescribes: the most compressed one, or the most stretched where none shrinks.
double leading_rate(const Eigen::Matrix3d& D);

double path_parameter(const Drive& drive, double t);       ///< e(t), exact at both ends [-]
double path_parameter_rate(const Drive& drive, double t);  ///< de/dt [1/s]
CellMotion motion_at(const Drive& drive, double t);        ///< H, L and transport

}  // namespace grainlaw::dem
