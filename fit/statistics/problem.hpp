#pragma once
// A least-squares problem as it is solved, differentiated and judged: free parameters with their bounds, and blocks of
// model - data with exact derivatives. No solver's header in here.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

namespace grainlaw::fit {

/// Consecutive rows of a block that share a quantity.
struct Channel {
  std::string quantity;     ///< as in TestResidual
  int first = 0, rows = 0;  ///< rows of the block
  int excluded = 0;         ///< rows of the test outside the window
  double max_abs_data = 0;  ///< largest |datum| of the rows, in the unit of the quantity
};

struct ResidualBlock {
  std::string test;  ///< name of the test that the rows come from
  int cluster = 0;   ///< the packing: rows of different clusters are independent, of one cluster they are not
  std::vector<Channel> channels;
  Eigen::VectorXd weight;  ///< of each row; the cost is half the sum of (weight (model - data))^2. 0: shown, not fitted
  /// model - data of all rows at the parameters `x`, unweighted, and its row-major Jacobian d/dx unless null. False when
  /// the model is not defined at `x`. Called from several threads at once.
  std::function<bool(const double* x, double* misfit, double* jacobian)> evaluate;

  int rows() const { return static_cast<int>(weight.size()); }
};

struct FreeParameter {
  std::string name;             ///< of parameter_table()
  double start = 0;             ///< moved into the bounds when outside
  double lower = 0, upper = 0;  ///< both attainable
  double scale = 1;             ///< typical magnitude > 0; the solver sees x/scale
};

/// The parameter `name` of the table with its bounds, starting from `start`.
FreeParameter free_parameter(const std::string& name, double start);

enum class Loss {
  squares,  ///< of the misfits
  huber,    ///< rows that are far off count by their distance; docs/theory/fit.md, section Huber's loss
};
constexpr auto names_of(Loss) { return std::array{"squares", "huber"}; }

struct Problem {
  std::vector<FreeParameter> parameters;
  std::vector<ResidualBlock> blocks;
  Loss loss = Loss::squares;
};

/// Rows of all blocks.
int row_count(const std::vector<ResidualBlock>& blocks);

/// model - data of all rows of all blocks in order at the parameters `x`, unweighted, and its row-major Jacobian unless null.
/// Each block by one of `threads`, into its own rows. False when the model is not defined at `x` or something is not finite.
bool evaluate(const std::vector<ResidualBlock>& blocks, const Eigen::VectorXd& x, int threads, double* misfit,
              double* jacobian);

/// Values and Jacobian of `functor(const T* x, T* misfit) -> bool` by forward differentiation. `Jet` is a dual number of
/// Jet::DIMENSION partial derivatives: Jet(value), Jet(value, k), .a and .v. More `parameters` take more than one pass.
template <class Jet, class Functor>
auto differentiated(Functor functor, int parameters, int rows) {
  return [functor = std::move(functor), parameters, rows](const double* x, double* misfit, double* jacobian) {
    if (jacobian == nullptr || parameters == 0) return static_cast<bool>(functor(x, misfit));
    constexpr auto width = static_cast<std::size_t>(Jet::DIMENSION);
    const auto n = static_cast<std::size_t>(parameters), m = static_cast<std::size_t>(rows);
    std::vector<Jet> at(n), values(m);
    for (std::size_t first = 0; first < n; first += width) {
      const std::size_t last = std::min(n, first + width);
      for (std::size_t k = 0; k < n; ++k) at[k] = Jet(x[k]);
      for (std::size_t k = first; k < last; ++k) at[k] = Jet(x[k], static_cast<int>(k - first));
      if (!functor(at.data(), values.data())) return false;
      for (std::size_t i = 0; i < m; ++i) {
        misfit[i] = values[i].a;
        for (std::size_t k = first; k < last; ++k)
          jacobian[i * n + k] = values[i].v[static_cast<Eigen::Index>(k - first)];
      }
    }
    return true;
  };
}

}  // namespace grainlaw::fit
