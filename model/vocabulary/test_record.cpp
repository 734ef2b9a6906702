#include "model/vocabulary/test_record.hpp"

#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

const Eigen::Matrix3d* single_direction(const TestRecord& test) {
  return test.path.segments.size() == 1 ? &test.path.segments.front().direction.tensor : nullptr;
}

bool is_isotropic(const Eigen::Matrix3d& d) { return deviatoric_norm(d) <= 1e-12 * d.norm(); }

}  // namespace

std::string to_string(Role role) {
  if (role == Role::calibration) return "calibration";
  return role == Role::validation ? "validation" : "description";
}

Role role_from(const std::string& name) {
  for (const Role role : {Role::calibration, Role::validation, Role::description}) {
    if (name == to_string(role)) return role;
  }
  throw InvalidInput("role: '" + name + "' is none; give calibration, validation or description");
}

bool is_isotropic_loading(const TestRecord& test) {
  const auto* d = single_direction(test);
  return d && is_isotropic(*d) && d->trace() < 0;
}

bool is_isotropic_unloading(const TestRecord& test) {
  const auto* d = single_direction(test);
  return d && is_isotropic(*d) && d->trace() > 0;
}

bool is_pure_shear(const TestRecord& test) {
  const auto* d = single_direction(test);
  return d && std::abs(d->trace()) <= 1e-12 * d->norm() && d->norm() > 0;
}

}  // namespace grainlaw
