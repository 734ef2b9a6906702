#include "chain/studies/study_quantity.hpp"

#include <algorithm>
#include <cmath>

#include "model/student.hpp"

namespace grainlaw::chain {
namespace {

/// Mean of those that are defined.
struct Mean {
  double sum = 0;
  int count = 0;

  void add(double x) {
    if (!std::isfinite(x)) return;
    sum += x;
    ++count;
  }
  double root() const { return count > 0 ? std::sqrt(sum / count) : kMissing; }
};

/// psi - psi^r by packing, those of `seeds` first, then those that only the reference has.
Eigen::MatrixXd difference(const Eigen::MatrixXd& ours, const std::vector<std::uint64_t>& seeds,
                           const Eigen::MatrixXd& reference, const std::vector<std::uint64_t>& reference_seeds) {
  Eigen::MatrixXd moved = ours;
  for (std::size_t k = 0; k < reference_seeds.size(); ++k) {
    const auto found = std::find(seeds.begin(), seeds.end(), reference_seeds[k]);
    const Eigen::VectorXd psi = reference.col(static_cast<Eigen::Index>(k));
    if (found != seeds.end()) {
      moved.col(std::distance(seeds.begin(), found)) -= psi;
    } else {
      moved.conservativeResize(Eigen::NoChange, moved.cols() + 1);
      moved.rightCols(1) = -psi;
    }
  }
  return moved;
}

}  // namespace

StudyQuantity without_packing(const StudyQuantity& quantity, Eigen::Index c) {
  StudyQuantity rest = quantity;
  const Eigen::Index columns = quantity.influence.cols();
  if (columns < 3) {
    rest.values.setConstant(kMissing);
    return rest;
  }
  const auto n = static_cast<double>(columns);
  const Eigen::VectorXd moved = quantity.influence.col(c) * std::sqrt(n / (n - 1));
  rest.values -= moved;
  rest.influence.resize(Eigen::NoChange, columns - 1);
  for (Eigen::Index k = 0; k < columns; ++k) {
    if (k != c)
      rest.influence.col(k < c ? k : k - 1) =
          (quantity.influence.col(k) * std::sqrt(n * (n - 1)) + moved) / std::sqrt((n - 1) * (n - 2));
  }
  return rest;
}

QuantityError compare(const StudyQuantity& ours, const std::vector<std::uint64_t>& seeds,
                      const StudyQuantity& reference, const std::vector<std::uint64_t>& reference_seeds) {
  QuantityError e{reference.name, reference.in_error, kMissing, kMissing, kMissing, kMissing, kMissing};
  if (ours.values.size() == 0) return e;
  e.value = ours.values(ours.values.size() - 1);
  double largest = 0;
  for (const double r : reference.values) {
    if (std::isfinite(r)) largest = std::max(largest, std::abs(r));
  }
  if (!(largest > 0)) return e;
  const Eigen::MatrixXd moved = difference(ours.influence, seeds, reference.influence, reference_seeds);
  Mean squares, variance, own;
  for (Eigen::Index i = 0; i < ours.values.size(); ++i) {
    const double d = (ours.values(i) - reference.values(i)) / largest;
    if (!std::isfinite(d)) continue;
    if (ours.values.size() == 1) e.error = d;
    squares.add(d * d);
    variance.add(moved.row(i).squaredNorm() / (largest * largest));
    own.add(ours.influence.row(i).squaredNorm() / (largest * largest));
  }
  if (ours.values.size() > 1) e.error = squares.root();
  e.standard_error = variance.root();
  const auto n = static_cast<double>(seeds.size()), least = std::min(n, static_cast<double>(reference_seeds.size()));
  e.half_width = student_95(least - 1) * e.standard_error;
  e.sampling = student_95(n - 1) * own.root();
  return e;
}

}  // namespace grainlaw::chain
