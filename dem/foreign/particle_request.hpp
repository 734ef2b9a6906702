#pragma once
// The key "particles" of a mapping (docs/schemas/particles.schema.json): where somebody's spheres are, frame by frame, what their
// columns mean, where the forces of their contacts are or which law gives them, and in which units.

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dem/foreign/foreign_frame.hpp"
#include "model/files/json_document.hpp"
#include "model/vocabulary/enum_names.hpp"

namespace grainlaw::dem {

enum class ParticleFormat { lammps_dump, xyz, vtk, table, state };
constexpr auto names_of(ParticleFormat) { return std::array{"lammps-dump", "xyz", "vtk", "table", "state"}; }

/// Titles of columns; empty: the usual ones are looked for.
struct SphereColumns {
  std::string id, x, y, z, r, diameter, vx, vy, vz;
};

struct ContactRequest {
  ParticleFormat format = ParticleFormat::lammps_dump;  ///< dump local, or table
  std::vector<std::filesystem::path> files;             ///< one with all frames, or one for each
  std::string first = "id1", second = "id2";            ///< titles of the ids of the two spheres
  std::array<std::string, 3> force{"fx", "fy", "fz"};   ///< whole force, or its normal part
  std::array<std::string, 3> tangential{};              ///< added to it; empty: none
  std::array<std::string, 3> branch{};  ///< x_first - x_second; only where two images of a pair may touch
  bool on_second = false;               ///< the forces act on the second sphere, not on the first
};

struct ParticleRequest {
  std::string where;  ///< of the mapping, for messages: "map.json: tests[0].particles"
  ParticleFormat format = ParticleFormat::table;
  std::vector<std::filesystem::path> files;  ///< in the order of the frames
  SphereColumns columns;
  std::optional<ContactRequest> contacts;  ///< none: forces follow from the law below
  std::vector<Eigen::Matrix3d> cells;      ///< none: the files have them; one; or one for each frame [m]
  std::vector<double> times;               ///< of the frames; empty: those of the files, or step times time_step [s]
  double time_step = std::numeric_limits<double>::quiet_NaN();  ///< [s]
  double stiffness =
      std::numeric_limits<double>::quiet_NaN();  ///< k, the unit of P*; NaN: that of the state file [kg/s^2]
  double density = std::numeric_limits<double>::quiet_NaN();  ///< rho; NaN: E_kin, kinetic stress and I stay undefined
  double contact_viscosity = 0;                               ///< gamma of the declared law; needs velocities [kg/s]
  double length = 1, time = 1, force = 1;                     ///< units of the files in SI [m], [s], [N]
};

/// Reads the key, which obeys its schema; files are named relative to `folder`, '*' in a name stands for all that fit, in the
/// order of their numbers. Throws InvalidInput naming `where`, key and remedy.
ParticleRequest particle_request(const Json& particles, const std::filesystem::path& folder, const std::string& where);

/// The frames of a list of files, one after the other.
class FrameFiles {
 public:
  FrameFiles(ParticleFormat format, std::vector<std::filesystem::path> files)
      : format_(format), files_(std::move(files)) {}
  bool next(ForeignFrame& frame);

 private:
  ParticleFormat format_;
  std::vector<std::filesystem::path> files_;
  std::size_t opened_ = 0;
  std::unique_ptr<ForeignReader> reader_;
};

}  // namespace grainlaw::dem
