// Mixed control by SUNDIALS IDA beside predict_by_law(): there a linear solve for the free rates makes an ordinary
// differential equation of it, here it is the differential-algebraic one that it is, solved implicitly,
//   y' = f(y; D + sum_k A_k' M_k),   c_k(y) = c_k(0) + r_k e        unknowns: state y (16), free strains A_k
// D the segment's direction, M_k the free directions, c_k the stress or P that is given. The strain is D e + sum A_k M_k.

#include <gtest/gtest.h>
#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "predict/mixed_control.hpp"
#include "predict/segment_law.hpp"
#include "predict/solvers/sundials.hpp"
#include "tests/support/figure.hpp"

namespace grainlaw::predict {
namespace {

using testing::expect_figure;
using Quantity = Condition::Quantity;

/// The equations, for one segment from nu_0.
struct MixedControl {
  LawParameters<double> parameters;
  Rung rung;
  PathSegment segment;
  double nu_0;
  LawState<double> start;

  Eigen::Index free() const { return static_cast<Eigen::Index>(segment.conditions.size()); }

  /// Sum over the free directions.
  Eigen::Matrix3d along_free(const Eigen::VectorXd& a) const {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (Eigen::Index k = 0; k < free(); ++k)
      sum += a(k) * free_direction(segment.conditions[static_cast<std::size_t>(k)]).tensor;
    return sum;
  }

  Eigen::Matrix3d strain(double e, const Eigen::VectorXd& A) const {
    return segment.direction.tensor * e + along_free(A);
  }

  Unknowns rate(double e, const LawState<double>& y, const Eigen::VectorXd& A, const Eigen::VectorXd& A_rate) const {
    const double nu = nu_0 * std::exp(-strain(e, A).trace());
    const StrainRate D{segment.direction.tensor + along_free(A_rate)};
    return packed(law_rate(parameters, rung, Coupling::energy, y, nu, law_direction(D)));
  }

  /// What is given, linear in the state: P, or a component of P 1 + sigma'.
  Eigen::VectorXd given(const LawState<double>& y) const {
    Eigen::VectorXd c(free());
    for (Eigen::Index k = 0; k < free(); ++k) {
      const Condition& condition = segment.conditions[static_cast<std::size_t>(k)];
      c(k) = y.P;
      if (condition.quantity == Quantity::P_star) continue;
      const auto [i, j] = kComponentIndex[static_cast<std::size_t>(condition.free)];
      c(k) = tensor_of(y.sigma)(i, j) + (i == j ? y.P : 0);
    }
    return c;
  }

  Eigen::VectorXd wanted(double e) const {
    Eigen::VectorXd c = given(start);
    for (Eigen::Index k = 0; k < free(); ++k) c(k) += segment.conditions[static_cast<std::size_t>(k)].rate * e;
    return c;
  }

  /// A'(0), by Newton's method on d c/de = r.
  Eigen::VectorXd first_rate() const {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(free()), r = wanted(1) - wanted(0);
    const auto miss = [&](const Eigen::VectorXd& a) {
      return Eigen::VectorXd(given(unpacked(rate(0, start, none, a).data())) - r);
    };
    Eigen::VectorXd a = none;
    for (int i = 0; i < 30; ++i) {
      Eigen::MatrixXd tangent(free(), free());
      for (Eigen::Index k = 0; k < free(); ++k) {
        Eigen::VectorXd up = a, down = a;
        up(k) += 1e-6;
        down(k) -= 1e-6;
        tangent.col(k) = (miss(up) - miss(down)) / 2e-6;
      }
      a -= tangent.fullPivLu().solve(miss(a));
    }
    return a;
  }
};

int residual(double e, N_Vector y, N_Vector y_rate, N_Vector out, void* user) {
  const auto& problem = *static_cast<const MixedControl*>(user);
  const double *value = N_VGetArrayPointer(y), *slope = N_VGetArrayPointer(y_rate);
  const Eigen::Index free = problem.free();
  const LawState<double> state = unpacked(value);
  const Unknowns rate = problem.rate(e, state, Eigen::Map<const Eigen::VectorXd>(value + kUnknowns, free),
                                     Eigen::Map<const Eigen::VectorXd>(slope + kUnknowns, free));
  double* const r = N_VGetArrayPointer(out);
  for (std::size_t i = 0; i < kUnknowns; ++i) r[i] = slope[i] - rate[i];
  Eigen::Map<Eigen::VectorXd>(r + kUnknowns, free) = problem.given(state) - problem.wanted(e);
  return 0;
}

void free_context(SUNContext context) { SUNContext_Free(&context); }
void free_memory(void* memory) { IDAFree(&memory); }

/// State and free strains at the ascending places `e`, to `tolerance`.
struct Place {
  LawState<double> state;
  Eigen::Matrix3d strain;
};
std::vector<Place> solve(MixedControl problem, const std::vector<double>& e, double tolerance) {
  SUNContext made = nullptr;
  SUNContext_Create(nullptr, &made);
  const Owned<SUNContext, free_context> context(made);
  const auto size = static_cast<sunindextype>(kUnknowns) + problem.free();
  const Owned<N_Vector, N_VDestroy> y(N_VNew_Serial(size, made)), slope(N_VNew_Serial(size, made));
  const Owned<SUNMatrix, SUNMatDestroy> matrix(SUNDenseMatrix(size, size, made));
  const Owned<SUNLinearSolver, SUNLinSolFree> linear(SUNLinSol_Dense(y.get(), matrix.get(), made));
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(problem.free()), first = problem.first_rate();
  std::ranges::copy(packed(problem.start), N_VGetArrayPointer(y.get()));
  std::ranges::copy(none, N_VGetArrayPointer(y.get()) + kUnknowns);
  std::ranges::copy(problem.rate(0, problem.start, none, first), N_VGetArrayPointer(slope.get()));
  std::ranges::copy(first, N_VGetArrayPointer(slope.get()) + kUnknowns);
  const Owned<void*, free_memory> ida(IDACreate(made));
  EXPECT_EQ(IDAInit(ida.get(), residual, 0, y.get(), slope.get()), IDA_SUCCESS);
  EXPECT_EQ(IDASetUserData(ida.get(), &problem), IDA_SUCCESS);
  EXPECT_EQ(IDASStolerances(ida.get(), tolerance, 1e-4 * tolerance), IDA_SUCCESS);
  EXPECT_EQ(IDASetLinearSolver(ida.get(), linear.get(), matrix.get()), IDA_SUCCESS);
  EXPECT_EQ(IDASetMaxNumSteps(ida.get(), 100000), IDA_SUCCESS);
  std::vector<Place> places;
  for (const double at : e) {
    double reached = 0;
    if (at > 0) {
      EXPECT_EQ(IDASolve(ida.get(), at, &reached, y.get(), slope.get(), IDA_NORMAL), IDA_SUCCESS);
      EXPECT_EQ(reached, at);
    }
    const double* const value = N_VGetArrayPointer(y.get());
    places.push_back(
        {unpacked(value), problem.strain(at, Eigen::Map<const Eigen::VectorXd>(value + kUnknowns, problem.free()))});
  }
  return places;
}

PathSegment segment(Mode mode, double eps_dev, std::vector<Condition> conditions) {
  PathSegment s{mode, direction_of(mode), ExtentKind::eps_dev, eps_dev};
  s.conditions = std::move(conditions);
  return s;
}

/// Farthest of states and strains between the two ways.
double farthest(Rung rung, const PathSegment& segment) {
  LawParameters<double> p = published_parameters();
  p.anisotropy.a2 = 1.18;
  p.memory = {0.8, 0.7, 2.5, 10, 45, 9, 1.0, 0.7, 0.6, 1.18};
  const LawState<double> start = state_from_law(p, 0.70);
  const auto rows =
      predict_by_law(rung, p, Coupling::energy, {0.70, Branch::unloading, {segment}}, start, 20, {1e-9, 1e-13}, {}, {})
          .rows;
  // the path parameter, from what of the strain is not free: zz - yy of D2 whose volume is, zz of what has free sides
  const Eigen::Matrix3d& D = segment.direction.tensor;
  const bool volume = segment.conditions.front().free == Condition::volume;
  std::vector<double> e;
  for (const PredictedRow& row : rows) {
    const Eigen::Matrix3d& E = row.strain.tensor;
    e.push_back(volume ? (E(2, 2) - E(1, 1)) / (D(2, 2) - D(1, 1)) : E(2, 2) / D(2, 2));
  }
  const std::vector<Place> places = solve({p, rung, segment, 0.70, start}, e, 1e-10);
  double off = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const LawState<double>&a = rows[i].state, &b = places[i].state;
    for (const double here : {std::abs(a.P - b.P) / b.P, (a.sigma - b.sigma).norm() / b.P, (a.F - b.F).norm(),
                              (rows[i].strain.tensor - places[i].strain).norm()}) {
      if (!(here <= off)) off = here;
    }
  }
  EXPECT_GT(e.back(), 0.01);
  return off;
}

TEST(MixedControlDae, IsWhatTheLinearSolveForTheRatesGives) {
  for (const Rung rung : {Rung::evolution, Rung::memory}) {
    const std::string name = "mixed.dae." + to_string(rung) + ".";
    expect_figure(name + "triaxial",
                  farthest(rung, segment(Mode::UNI, 0.05, {{0, Quantity::stress, 0}, {1, Quantity::stress, 0}})), 1e-7);
    expect_figure(name + "constant_P",
                  farthest(rung, segment(Mode::D2, 0.05, {{Condition::volume, Quantity::P_star, 0}})), 1e-7);
    expect_figure(name + "ramp", farthest(rung, segment(Mode::D2, 0.05, {{Condition::volume, Quantity::P_star, 0.02}})),
                  1e-7);
  }
}

}  // namespace
}  // namespace grainlaw::predict
