#pragma once
// A strain path: straight segments in logarithmic strain, one after the other (Table 1 and its superpositions).
//
//   dE = D de,  e in [0, length]        E logarithmic strain, D direction of the segment, e path parameter
//   eps_vol = tr E = ln(V/V0),  nu(e) = nu_start exp(-tr(D) e),  eps_dev by Eq. (4)
// A velocity gradient L = D + W per unit of e has a spin W (antisymmetric) besides; E is the integral of D in fixed axes.
// Mixed control: rates that a condition leaves free are whatever keeps stresses, P or the stress ratio to theirs. Where
// such a segment, or one up to a target of the law, leads is decided by the law: resolve() refuses it, predict/ walks it.
// Signs: tension positive, so ISO compression has D = diag(-1,-1,-1). All quantities dimensionless.

#include <string>
#include <vector>

#include "model/vocabulary/enum_names.hpp"
#include "model/vocabulary/tensor.hpp"

namespace grainlaw {

enum class Mode { ISO, UNI, D2, D3, tensor };  ///< `tensor`: the direction is given by the user
constexpr auto names_of(Mode) { return std::array{"ISO", "UNI", "D2", "D3", "tensor"}; }

enum class Branch { loading, unloading };  ///< branch of the isotropic preparation that a state was kept on
constexpr auto names_of(Branch) { return std::array{"loading", "unloading"}; }

/// What ends a segment: strain added (eps_dev, eps_vol) or a value reached; the last two are known to the law only.
enum class ExtentKind { eps_dev, eps_vol, target_nu, target_eps_dev, target_P_star, target_stress_ratio };
constexpr auto names_of(ExtentKind) {
  return std::array{"eps_dev", "eps_vol", "target_nu", "target_eps_dev", "target_P_star", "target_stress_ratio"};
}

/// Strain-rate direction of a mode as printed in section 1.2 of the paper (compression of z), reversed on request.
/// `axes` says which box axis plays the role of the paper's x, y and z, e.g. "xyz" or "yzx". Not for Mode::tensor.
StrainRate direction_of(Mode mode, const std::string& axes = "xyz", bool reverse = false);

/// In place of the strain rate along free_direction(free): `quantity` changes by `rate` per unit of e.
struct Condition {
  enum class Quantity { stress, P_star, stress_ratio };  ///< sigma*_ij of component `free`; P*; |sigma'|/P
  static constexpr int volume = 6;

  int free = volume;  ///< what is free: index in kComponentName, or `volume`
  Quantity quantity = Quantity::P_star;
  double rate = 0;  ///< compression positive, 0 holds the quantity [-]
};

constexpr auto names_of(Condition::Quantity) { return std::array{"stress", "P_star", "stress_ratio"}; }

/// "xx" ... "xy", "volume".
std::string free_name(const Condition& condition);

/// Unit rate of what is free: one for the component (both places of a shear), or diag(1,1,1)/3.
StrainRate free_direction(const Condition& condition);

/// A segment as a user writes it.
struct PathSegment {
  Mode mode = Mode::ISO;                         ///< what the segment is called in files and figures
  StrainRate direction;                          ///< D, tension positive [-]
  ExtentKind extent_kind = ExtentKind::eps_dev;  ///< what `extent` measures
  double extent = 0;  ///< magnitude of deviatoric or volumetric strain added, or the value to reach [-]
  Eigen::Matrix3d spin = Eigen::Matrix3d::Zero();  ///< W, antisymmetric [-]
  std::vector<Condition> conditions = {};          ///< mixed control; none: D is all there is
};

/// Whether the law decides where the segment leads: it has conditions or ends at a target of the law.
bool law_decides(const PathSegment& segment);

struct Path {
  double nu = 0;                      ///< volume fraction at the start [-]
  Branch branch = Branch::unloading;  ///< which kept state the path starts from
  std::vector<PathSegment> segments;  ///< in order of time
};

bool law_decides(const Path& path);  ///< any of its segments

/// A segment with its extent resolved against the volume fraction at its start.
struct StraightSegment {
  Mode mode = Mode::ISO;
  StrainRate direction;  ///< D, tension positive [-]
  double length = 0;     ///< final value of the path parameter e [-]
  double nu_start = 0;   ///< volume fraction at e = 0 [-]
  Strain strain_start;   ///< total logarithmic strain at e = 0, counted from the start of the path [-]
  Eigen::Matrix3d spin = Eigen::Matrix3d::Zero();  ///< W: rotation per unit of e, antisymmetric [-]
  bool portable = false;  ///< what follows from it is the same bits on every machine (model/vocabulary/portable.hpp)

  double nu(double e) const;      ///< volume fraction at path parameter e [-]
  Strain strain(double e) const;  ///< total strain at e [-]; segments add logarithmic strains (exact for coaxial paths)
  double eps_dev_rate() const;    ///< |D|_dev: deviatoric strain per unit of e [-]
  double eps_vol_rate() const;    ///< tr D: volumetric strain per unit of e [-]
};

/// Of shear beside volumetric strain, or the reverse: what digits of a table or an axis a little off leave of one that is meant to be
/// none.
inline constexpr double kPathNoise = 1e-3;

/// Whether a direction shears, beyond noise.
bool shears(const StrainRate& direction);

/// Volume fractions that are one: kept states differ by rounding, packings of others by more.
inline constexpr double kSameDensity = 1e-3;

/// Whether two paths are one, however they are written: volume fractions within kSameDensity, strains of legs within 1 %.
bool same_path(const std::vector<StraightSegment>& a, const std::vector<StraightSegment>& b);
/// Likewise from the same branch; false where the law decides where one of them leads.
bool same_path(const Path& a, const Path& b);
/// Whether two paths are one for a law, which knows no axes: after some rotation or reflection.
bool same_but_axes(const std::vector<StraightSegment>& a, const std::vector<StraightSegment>& b);

inline constexpr double kMaxVolumeFraction = 0.9;  ///< beyond it overlaps are no small fraction of the radius any more

/// Resolves every extent. Throws InvalidInput naming the segment when an extent cannot be reached by its direction
/// (deviatoric extent of ISO, volumetric extent of D2, wrong sign of a target), is not finite or not positive, when
/// nu leaves (0, 0.9], or when the law decides where the segment leads.
std::vector<StraightSegment> resolve(const Path& path, bool portable = false);

/// One segment, `index` for messages, that starts at `nu` and `strain`.
StraightSegment resolve(const PathSegment& segment, std::size_t index, double nu, const Strain& strain,
                        bool portable = false);

/// Throws InvalidInput, as resolve() does, for whatever is wrong about a path without asking the law.
void check(const Path& path);

/// N of the path's first deviatoric segment in compression-positive sense: the direction that s_par and F_par are
/// measured along. Zero when no segment has a deviator.
Deviator<double> shear_direction(const std::vector<StraightSegment>& segments);

}  // namespace grainlaw
