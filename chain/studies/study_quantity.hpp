#pragma once
// What the packings of a setting say of one quantity, and how far that is from a reference. psi_c is what packing c moved the
// value by, x_i a value (of a number, or of a curve at its points), r_i the reference's:
//   d_i = (x_i - r_i)/max|r|,   variance of d_i = sum over packings of (psi_i,c - psi^r_i,c)^2/max|r|^2
// Packings are the same if their seeds are; what both owe to one packing cancels. Numbers: error = d. Curves: error = root
// mean square of d_i over the points, its standard error likewise.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

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

/// The same without the packing of column `c`, to first order (exactly where a value is the mean of the packings); not shown with
/// fewer than three:
///   x' = x - psi_c sqrt(n/(n - 1)),   psi_k' = (psi_k sqrt(n (n - 1)) + psi_c sqrt(n/(n - 1)))/sqrt((n - 1)(n - 2))
StudyQuantity without_packing(const StudyQuantity& quantity, Eigen::Index c);

/// Seeds in the order of the columns of `influence`.
QuantityError compare(const StudyQuantity& ours, const std::vector<std::uint64_t>& seeds,
                      const StudyQuantity& reference, const std::vector<std::uint64_t>& reference_seeds);

}  // namespace grainlaw::chain
