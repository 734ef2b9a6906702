#include "fit/statistics/covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace grainlaw::fit {
namespace {

/// Rows of a fitted mean: J = 1, misfit = mean - y.
struct Mean {
  Eigen::MatrixXd J;
  Eigen::VectorXd misfit;
  std::vector<int> cluster;
};

/// Runs that each repeat one number `rows` times: as correlated as rows can be.
Mean mean_of(const std::vector<double>& run_value, int rows) {
  Mean m;
  const auto n = static_cast<Eigen::Index>(run_value.size()) * rows;
  m.J = Eigen::MatrixXd::Ones(n, 1);
  m.misfit.resize(n);
  double mean = 0;
  for (double v : run_value) mean += v / static_cast<double>(run_value.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    m.cluster.push_back(static_cast<int>(i / rows));
    m.misfit(i) = mean - run_value[static_cast<std::size_t>(i / rows)];
  }
  return m;
}

TEST(Covariance, ErrorOfAMeanIsThatOfTheRunsHoweverOftenEachIsRead) {
  // Variance of a mean of G values: sum (y - mean)^2/(G (G-1)) = (1 + 1 + 4)/6 for y = 1, 1, 4 shifted to mean 2.
  for (const int rows : {1, 10, 1000}) {
    const Mean m = mean_of({1, 1, 4}, rows);
    const ClusterCovariance c = cluster_covariance(m.J, m.misfit, m.cluster, {true});
    EXPECT_NEAR(c.covariance()(0, 0), 6. / 6, 1e-12) << rows;
    EXPECT_TRUE(c.identified[0]);
    EXPECT_TRUE(c.has_error[0]);
  }
}

// Sum over packings of the squared deviations of their own fits, here straight lines: V = sum (x_c - x)(x_c - x)^T/(G (G-1)).
TEST(Covariance, PackingsThatShareAlikeGiveTheVarianceOfTheMeanOfTheirFits) {
  const Eigen::Index G = 5, n = 20;
  Eigen::MatrixXd J(G * n, 2);
  Eigen::VectorXd misfit(G * n);
  std::vector<int> cluster;
  for (Eigen::Index i = 0; i < G * n; ++i) {
    J.row(i) << 1, static_cast<double>(i % n) / static_cast<double>(n);
    misfit(i) = std::sin(1e4 * static_cast<double>(i * i % 7919)) + 0.3 * std::cos(static_cast<double>(i / n));
    cluster.push_back(static_cast<int>(i / n));
  }
  misfit -= J * (J.transpose() * J).inverse() * (J.transpose() * misfit);  // as after a fit
  Eigen::Matrix2d expected = Eigen::Matrix2d::Zero();
  for (Eigen::Index c = 0; c < G; ++c) {
    const Eigen::MatrixXd J_c = J.middleRows(c * n, n);
    const Eigen::Vector2d off = (J_c.transpose() * J_c).inverse() * (J_c.transpose() * misfit.segment(c * n, n));
    expected += off * off.transpose() / static_cast<double>(G * (G - 1));
  }
  const ClusterCovariance c = cluster_covariance(J, misfit, cluster, {true, true});
  EXPECT_NEAR((c.covariance() - expected).norm(), 0, 1e-12 * expected.norm());
  EXPECT_NEAR(c.degrees_of_freedom(0), G - 1, 1e-9);
  EXPECT_NEAR(c.degrees_of_freedom(1), G - 1, 1e-9);
}

// J = 1 and packings of n_c rows, white noise: the influences are those of a mean of packing means with weights n_c/n, and
// Satterthwaite's count lies between that of equal shares and that of the largest packing alone.
TEST(Covariance, UnequalPackingsCountForFewer) {
  std::vector<double> counted;
  for (const int largest : {10, 20, 40, 60}) {
    std::vector<int> cluster;
    for (int c = 0; c < 4; ++c) cluster.insert(cluster.end(), static_cast<std::size_t>(c == 0 ? largest : 10), c);
    const auto n = static_cast<Eigen::Index>(cluster.size());
    const Eigen::VectorXd misfit = Eigen::VectorXd::LinSpaced(n, -1, 1);
    counted.push_back(cluster_covariance(Eigen::MatrixXd::Ones(n, 1), misfit, cluster, {true}).degrees_of_freedom(0));
  }
  EXPECT_NEAR(counted[0], 3, 1e-9);
  for (std::size_t k = 1; k < counted.size(); ++k) {
    EXPECT_LT(counted[k], counted[k - 1]);
    EXPECT_GE(counted[k], 1);
  }
}

TEST(Covariance, ResponseIsThatOfTheNormalEquations) {
  Eigen::MatrixXd J(5, 3), change(3, 2), S(3, 3);
  J << 1, 2, 0, 0, 1, 3, 2, 0, 1, 1, 1, 1, 4, 0, 2;
  change << 1, 0, -1, 2, 0.5, 1;
  S << 1, 0.5, 0, 0.5, -0.2, 0.1, 0, 0.1, 2;
  const std::vector<int> two{0, 2};
  for (const Eigen::MatrixXd& curvature : {Eigen::MatrixXd(), S}) {
    const Eigen::MatrixXd A = J.transpose() * J + (curvature.size() > 0 ? S : Eigen::MatrixXd::Zero(3, 3).eval());
    const Eigen::MatrixXd all = response(J, {true, true, true}, change, curvature);
    EXPECT_NEAR((all + A.inverse() * change).norm(), 0, 1e-12);
    const Eigen::MatrixXd held = response(J, {true, false, true}, change, curvature);
    EXPECT_NEAR((held(two, Eigen::all) + A(two, two).inverse() * change(two, Eigen::all)).norm(), 0, 1e-12);
    EXPECT_EQ(held.row(1).norm(), 0);
    EXPECT_NEAR((naive_variance(J, {true, true, true}, curvature) - A.inverse().diagonal()).norm(), 0, 1e-12);
  }
}

// A cost that curves downwards is not at a minimum: its valley is taken as flat, not as a hill.
TEST(Covariance, CurvatureNeverTurnsAValleyIntoAHill) {
  const Mean m = mean_of({1, 1, 4}, 1);
  const double naive = naive_variance(m.J, {true})(0);
  for (const double S : {-2.9, -3.0, -7.0}) {
    const double variance = naive_variance(m.J, {true}, Eigen::MatrixXd::Constant(1, 1, S))(0);
    EXPECT_NEAR(variance, 10 * naive, 1e-9) << S;
  }
}

TEST(Covariance, OneRunHasNoError) {
  const Mean m = mean_of({2}, 50);
  const ClusterCovariance c = cluster_covariance(m.J, m.misfit, m.cluster, {true});
  EXPECT_TRUE(c.identified[0]);
  EXPECT_FALSE(c.has_error[0]);
  EXPECT_EQ(c.covariance()(0, 0), 0);
}

TEST(Covariance, AParameterOnFewOfManyRunsCountsThoseRunsOnly) {
  // Parameter 0 is the mean of runs 0 and 1, parameter 1 that of runs 2..9: two separate problems in one.
  const Eigen::Vector2d two(0.5, -0.5);
  Eigen::VectorXd eight(8);
  eight << 1, -1, 2, -2, 3, -3, 4, -4;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(10, 2);
  Eigen::VectorXd misfit(10);
  std::vector<int> cluster;
  for (Eigen::Index i = 0; i < 10; ++i) {
    J(i, i < 2 ? 0 : 1) = 1;
    misfit(i) = i < 2 ? two(i) : eight(i - 2);
    cluster.push_back(static_cast<int>(i));
  }
  const ClusterCovariance c = cluster_covariance(J, misfit, cluster, {true, true});
  EXPECT_NEAR(c.covariance()(0, 0), two.squaredNorm() / (2 * 1), 1e-12);
  EXPECT_NEAR(c.covariance()(1, 1), eight.squaredNorm() / (8 * 7), 1e-12);
  EXPECT_NEAR(c.covariance()(0, 1), 0, 1e-15);
  EXPECT_NEAR(c.degrees_of_freedom(0), 1, 1e-12);
  EXPECT_NEAR(c.degrees_of_freedom(1), 7, 1e-12);
}

TEST(Covariance, CombinationsKeepTheirErrorWhenParametersAreHardlySeparable) {
  // Two almost parallel columns: a curve x0 + x1 (1 + small t) whose middle is known although x0 and x1 are not.
  Eigen::MatrixXd J(40, 2);
  Eigen::VectorXd misfit(40);
  std::vector<int> cluster;
  for (Eigen::Index i = 0; i < 40; ++i) {
    const double t = static_cast<double>(i % 10) / 9 - 0.5;
    J.row(i) << 1, 1 + 1e-3 * t;
    misfit(i) = std::sin(2.3 * static_cast<double>(i / 10)) + 0.1 * t * (i < 20 ? 1 : -1);
    cluster.push_back(static_cast<int>(i / 10));
  }
  misfit.array() -= misfit.mean();
  const ClusterCovariance c = cluster_covariance(J, misfit, cluster, {true, true});
  ASSERT_TRUE(c.has_error[0] && c.has_error[1]);
  const double middle = c.covariance()(0, 0) + 2 * c.covariance()(0, 1) + c.covariance()(1, 1);
  double runs = 0;  // variance of the mean of four run means
  for (int r = 0; r < 4; ++r) runs += std::pow(misfit.segment(10 * r, 10).mean(), 2) / (4 * 3);
  EXPECT_NEAR(middle, runs, 1e-3 * runs);
  EXPECT_GT(c.covariance()(0, 0), 1e3 * middle);
}

TEST(Covariance, NullDirectionsTakeTheirParametersOnly) {
  // Columns 0 and 1 are proportional, column 3 is zero: only parameter 2 is determined.
  Eigen::MatrixXd J(6, 4);
  std::vector<int> cluster;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double t = static_cast<double>(i);
    J.row(i) << t, 3 * t, 1, 0;
    cluster.push_back(static_cast<int>(i));
  }
  const Eigen::VectorXd misfit = Eigen::VectorXd::Constant(6, 0.1);
  const ClusterCovariance c = cluster_covariance(J, misfit, cluster, {true, true, true, true});
  EXPECT_EQ(c.identified, (std::vector<bool>{false, false, true, false}));
  EXPECT_GT(c.covariance()(2, 2), 0);
}

TEST(Covariance, HeldParametersAreKnownAndHaveNoError) {
  const Mean m = mean_of({1, 1, 4}, 2);
  Eigen::MatrixXd J(m.J.rows(), 2);
  J << m.J, m.J;  // with both free, neither is determined
  EXPECT_EQ(cluster_covariance(J, m.misfit, m.cluster, {true, true}).identified, (std::vector<bool>{false, false}));
  const ClusterCovariance c = cluster_covariance(J, m.misfit, m.cluster, {true, false});
  EXPECT_EQ(c.identified, (std::vector<bool>{true, true}));
  EXPECT_EQ(c.has_error, (std::vector<bool>{true, false}));
  EXPECT_EQ(c.covariance()(1, 1), 0);
}

TEST(Covariance, NoErrorWithoutADegreeOfFreedom) {
  Eigen::MatrixXd J(2, 2);
  J << 1, 0, 1, 1;
  const ClusterCovariance c = cluster_covariance(J, Eigen::VectorXd::Zero(2), {0, 1}, {true, true});
  EXPECT_TRUE(c.identified[0] && c.identified[1]);
  EXPECT_FALSE(c.has_error[0] || c.has_error[1]);
}

TEST(Covariance, DataThatMoveWithNothingDetermineNothing) {
  const ClusterCovariance c =
      cluster_covariance(Eigen::MatrixXd::Zero(3, 2), Eigen::VectorXd::Ones(3), {0, 1, 1}, {true, true});
  EXPECT_EQ(c.identified, (std::vector<bool>{false, false}));
  EXPECT_EQ(c.has_error, (std::vector<bool>{false, false}));
  EXPECT_EQ(c.covariance().norm(), 0);
}

}  // namespace
}  // namespace grainlaw::fit
