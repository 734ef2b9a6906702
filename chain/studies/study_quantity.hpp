#pragma once
// What the packings of a setting say of one quantity, a number or a curve at its points, and how far that is from a
// reference. psi_c is what packing c moved a value by; packings are the same if their seeds are, and what both owe to one
// packing cancels. Formulas: docs/theory/studies.md, section Quantities of a setting.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "model/vocabulary/fields.hpp"

namespace grainlaw::chain {

inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();  ///< value of what is not shown

struct StudyQuantity {
  std::string name;
  Eigen::VectorXd values;     ///< one, or one for each point of a curve; NaN: not shown [-]
  Eigen::MatrixXd influence;  ///< values x packings: psi [-]
  bool in_error = true;       ///< counts in the error of a setting
};

struct QuantityError {
  std::string quantity;
  bool in_error = true;
  double value = 0;           ///< of a curve its last [-]
  double error = 0;           ///< relative difference from the reference; NaN where one of them does not show it [-]
  double standard_error = 0;  ///< of `error`, from the scatter over packings [-]
  double half_width = 0;      ///< likewise, of its 95 % interval: Student's t for the setting with fewer packings [-]
  double sampling = 0;        ///< half width of the 95 % interval of the values themselves, relative as `error` [-]
  double chance = kMissing;   ///< standard error pooled over settings that scatter alike: a unit of errors [-]
};
GRAINLAW_FIELDS(QuantityError, quantity, in_error, value, error, standard_error, half_width, sampling, chance);

/// The same without the packing of column `c`, to first order (exactly where a value is the mean of the packings); not shown with
/// fewer than three.
StudyQuantity without_packing(const StudyQuantity& quantity, Eigen::Index c);

/// Seeds in the order of the columns of `influence`.
QuantityError compare(const StudyQuantity& ours, const std::vector<std::uint64_t>& seeds,
                      const StudyQuantity& reference, const std::vector<std::uint64_t>& reference_seeds);

}  // namespace grainlaw::chain
