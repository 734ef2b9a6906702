#include "model/vocabulary/test_record.hpp"

namespace grainlaw {
namespace {

const Eigen::Matrix3d* single_direction(const TestRecord& test) {
  return test.path.segments.size() == 1 ? &test.path.segments.front().direction.tensor : nullptr;
}

bool is_isotropic(const Eigen::Matrix3d& d) { return deviatoric_norm(d) <= 1e-12 * d.norm(); }

}  // namespace

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
