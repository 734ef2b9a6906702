#include "model/vocabulary/test_record.hpp"

#include <fmt/format.h>

namespace grainlaw {
namespace {

const Eigen::Matrix3d* single_direction(const TestRecord& test) {
  return test.path.segments.size() == 1 ? &test.path.segments.front().direction.tensor : nullptr;
}

bool is_isotropic(const Eigen::Matrix3d& d) { return !shears({d}); }

std::string text_of(const ContactModel& contacts) {
  return fmt::format("{}, friction {}, rolling friction {}, cohesion {} J/m^2", to_string(contacts.normal_force),
                     contacts.friction, contacts.rolling_friction, contacts.cohesion);
}

}  // namespace

std::string other_material(const PackingInfo& ours, const PackingInfo& theirs) {
  if (ours.size_width > 0 && theirs.size_width > 0 && ours.size_width != theirs.size_width)
    return fmt::format("size_width of its packing: {}, but {}", ours.size_width, theirs.size_width);
  if (ours.contacts != theirs.contacts)
    return fmt::format("contacts of its packing: {}, but {}", text_of(ours.contacts), text_of(theirs.contacts));
  return "";
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
