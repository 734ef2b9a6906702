#pragma once
// A strain path: straight segments in logarithmic strain, one after the other (Table 1 and its superpositions).
//
//   dE = D de,  e in [0, length]        E logarithmic strain, D direction of the segment, e path parameter
//   eps_vol = tr E = ln(V/V0),  nu(e) = nu_start exp(-tr(D) e),  eps_dev by Eq. (4)
// Signs: tension positive, so ISO compression has D = diag(-1,-1,-1). All quantities dimensionless.

#include <string>
#include <vector>

#include "model/tensor.hpp"

namespace grainlaw {

enum class Mode { ISO, UNI, D2, D3, tensor };  ///< `tensor`: the direction is given by the user
enum class Branch { loading, unloading };      ///< branch of the isotropic preparation that a state was kept on
enum class ExtentKind { eps_dev, eps_vol, target_nu };

std::string to_string(Mode mode);
std::string to_string(Branch branch);

/// Strain-rate direction of a mode as printed in section 1.2 of the paper (compression of z), reversed on request.
/// `axes` says which box axis plays the role of the paper's x, y and z, e.g. "xyz" or "yzx". Not for Mode::tensor.
StrainRate direction_of(Mode mode, const std::string& axes = "xyz", bool reverse = false);

/// A segment as a user writes it.
struct PathSegment {
  Mode mode = Mode::ISO;                         ///< what the segment is called in files and figures
  StrainRate direction;                          ///< D, tension positive [-]
  ExtentKind extent_kind = ExtentKind::eps_dev;  ///< what `extent` measures
  double extent = 0;  ///< magnitude of deviatoric or volumetric strain added, or the volume fraction to reach [-]
};

struct Path {
  double nu = 0;                        ///< volume fraction at the start [-]
  Branch branch = Branch::unloading;    ///< which kept state the path starts from
  std::vector<PathSegment> segments;    ///< in order of time
};

/// A segment with its extent resolved against the volume fraction at its start.
struct StraightSegment {
  Mode mode = Mode::ISO;
  StrainRate direction;   ///< D, tension positive [-]
  double length = 0;      ///< final value of the path parameter e [-]
  double nu_start = 0;    ///< volume fraction at e = 0 [-]
  Strain strain_start;    ///< total logarithmic strain at e = 0, counted from the start of the path [-]

  double nu(double e) const;       ///< volume fraction at path parameter e [-]
  Strain strain(double e) const;   ///< total strain at e [-]; segments add logarithmic strains (exact for coaxial paths)
  double eps_dev_rate() const;     ///< |D|_dev: deviatoric strain per unit of e [-]
  double eps_vol_rate() const;     ///< tr D: volumetric strain per unit of e [-]
};

/// Resolves every extent. Throws InvalidInput naming the segment when an extent cannot be reached by its direction
/// (deviatoric extent of ISO, volumetric extent of D2, wrong sign of a target), is not finite or not positive, or
/// when nu leaves (0, 0.9].
std::vector<StraightSegment> resolve(const Path& path);

/// N of the path's first deviatoric segment in compression-positive sense: the direction that s_par and F_par are
/// measured along. Zero when no segment has a deviator.
Deviator<double> shear_direction(const std::vector<StraightSegment>& segments);

}  // namespace grainlaw
