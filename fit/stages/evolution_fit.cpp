#include "fit/stages/evolution_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "fit/stages/evolution_checks.hpp"
#include "fit/stages/trajectory_misfit.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kVolumetricPath = 1e-3;  // |d eps_vol| of a trajectory that says something about the coupling

std::string quantity_name(char symbol, std::size_t axis) {
  return axis == 0 ? std::string(1, symbol) + "_par" : std::string(1, symbol) + "_axis" + std::to_string(axis + 1);
}

ResidualBlock evolution_block(const Trajectory& t, const LawParameters<double>& fixed,
                              const std::vector<std::size_t>& index, const CalibrationOptions& options) {
  const auto rows = static_cast<Eigen::Index>(t.rows.size());
  const auto axes = static_cast<Eigen::Index>(t.axes.size());
  ResidualBlock block;
  block.test = t.test;
  block.cluster = t.cluster;
  block.weight = Eigen::VectorXd::Zero(rows * (1 + 2 * axes));
  const auto add = [&](const std::string& quantity, Eigen::Index first, auto datum, auto weight) {
    Channel channel{quantity, static_cast<int>(first), static_cast<int>(rows), t.excluded, 0};
    for (Eigen::Index i = 0; i < rows; ++i) {
      const TrajectoryRow& row = t.rows[static_cast<std::size_t>(i)];
      channel.max_abs_data = std::max(channel.max_abs_data, std::abs(datum(row.data)));
      block.weight(first + i) = weight(row);
    }
    block.channels.push_back(channel);
  };
  // Relative to the law so far: by each row's own P* weights would be larger where its packing or noise makes it small, and the
  // law too low, by twice the variance of ln P*.
  add(
      "P_star", 0, [](const LawState<double>& y) { return y.P; },
      [&](const TrajectoryRow& row) {
        const double P = fixed.isotropic.P_star(t.nu(row.e));
        return t.starts_on_law && P > 0 ? row.weight / (options.pressure_scale * P) : 0.0;
      });
  for (Eigen::Index a = 0; a < axes; ++a) {
    const Deviator<double>& n = t.axes[static_cast<std::size_t>(a)];
    add(
        quantity_name('s', static_cast<std::size_t>(a)), rows * (1 + a),
        [&](const LawState<double>& y) { return y.sigma.dot(n) / y.P; },
        [&](const TrajectoryRow& row) { return row.weight / options.stress_scale; });
    add(
        quantity_name('F', static_cast<std::size_t>(a)), rows * (1 + axes + a),
        [&](const LawState<double>& y) { return y.F.dot(n); },
        [&](const TrajectoryRow& row) { return row.weight / options.fabric_scale; });
  }
  block.evaluate =
      differentiated({t, fixed, index, Rung::evolution, options.coupling, options.max_step, t.axes.size()});
  return block;
}

/// sigma_N/(B F_N) of a test's steady rows, as one of sums: the fabric of a row may be none by chance.
struct RatioOfTest {
  int packing = 0;
  double sigma = 0, B_F = 0;
  double value() const { return sigma / B_F; }
};

std::string evolution_window(const CalibrationOptions& options) {
  return fmt::format(
      "all trajectories, each segment from its measured start: P* of ISO unloading (nu >= {:g}, start on Eq. (14)) "
      "relative to the law so far, scale {:g}; s_par scale {:g} and F_par scale {:g} in shear, at constant "
      "volume 0 < eps_dev <= {:g} and, with {:g} times the weight, eps_dev >= {:g}, elsewhere all rows; P* in shear is "
      "shown without weight because Eq. (16) has no dilatancy",
      options.iso_nu_min, options.pressure_scale, options.stress_scale, options.fabric_scale, options.rate_window,
      options.steady_weight, options.steady_from);
}

/// Smallest volume fraction of the rows.
double least_nu(const std::vector<Trajectory>& trajectories) {
  double least = 1;
  for (const Trajectory& t : trajectories) {
    if (t.rows.empty()) continue;
    least = std::min({least, t.nu_start, t.nu(t.rows.back().e)});
  }
  return least;
}

}  // namespace

bool contains_anisotropy(const std::vector<Trajectory>& trajectories) {
  return std::ranges::any_of(trajectories, [](const Trajectory& t) {
    return !t.axes.empty() && !t.rows.empty() && std::abs(t.direction.dx) * t.rows.back().e > kVolumetricPath;
  });
}

std::vector<ResidualBlock> evolution_blocks(const std::vector<Trajectory>& trajectories,
                                            const LawParameters<double>& law, const std::vector<std::string>& free,
                                            const CalibrationOptions& options) {
  std::vector<std::size_t> index;
  for (const std::string& name : free) index.push_back(parameter_index(name));
  std::vector<ResidualBlock> blocks;
  for (const Trajectory& t : trajectories) blocks.push_back(evolution_block(t, law, index, options));
  return blocks;
}

StageDefinition evolution_stage(const std::vector<Trajectory>& trajectories, const std::vector<std::string>& held,
                                const CalibrationOptions& options) {
  const std::string coupling = options.coupling == Coupling::energy ? "anisotropy.a2" : "anisotropy.a0";
  const bool anisotropy = contains_anisotropy(trajectories);
  StageDefinition stage;
  stage.name = "evolution";
  stage.window = evolution_window(options);
  stage.free = parameters_of("pressure");
  for (const std::string law : {"stress_ratio_max", "stress_rate", "fabric_max", "fabric_rate"}) {
    if (std::find(held.begin(), held.end(), law) != held.end()) continue;
    for (const std::string& name : parameters_of(law)) stage.free.push_back(name);
  }
  if (anisotropy)
    stage.free.push_back(coupling);
  else
    stage.absent = {{coupling, {0, kUndefined, Status::not_identified, kChangeTheVolume}}};
  stage.remedy = "the trajectories do not determine it; test more densities, and D2 to steady state";
  stage.least_nu = least_nu(trajectories);
  stage.blocks = [=, free = stage.free](const LawParameters<double>& law) {
    return evolution_blocks(trajectories, law, free, options);
  };
  stage.given = {"coordination", "rattlers"};
  stage.judge = [=](StageFit& fit, const LawParameters<double>& law) {
    check_evolution(trajectories, law, options, fit);
    if (anisotropy) check_coupling(coupling, kChangeTheVolume, fit);
  };
  stage.coupled = stage.profiled = true;
  return stage;
}

TiedCoupling tied_a1(const std::vector<Trajectory>& trajectories, const LawParameters<double>& law, const Estimate& a2,
                     const Eigen::RowVectorXd& influence_on_a2, const CalibrationOptions& options) {
  TiedCoupling tied{{}, Eigen::RowVectorXd::Zero(influence_on_a2.size())};
  Estimate& a1 = tied.a1;
  a1.note = "follows from a2 by A1 = (2/3)(A2 - sigma_dev): " + a2.note;
  if (a2.status == Status::not_identified) return tied;
  std::map<std::string, RatioOfTest> ratios;
  for (const Trajectory& t : trajectories) {
    if (!t.constant_volume()) continue;
    const double B = law.isotropic.B_star(t.nu_start);
    for (const TrajectoryRow& row : t.rows) {
      const double F = row.data.F.dot(t.direction.N);
      if (t.direction.de * row.e < options.steady_from || std::isnan(F)) continue;
      RatioOfTest& ratio = ratios[t.test];
      ratio.packing = t.cluster;
      ratio.sigma += row.data.sigma.dot(t.direction.N);
      ratio.B_F += B * F;
    }
  }
  std::erase_if(ratios, [](const auto& test) { return !(test.second.B_F > 0); });
  if (ratios.empty()) {
    a1.note = "no steady shear to refer it to; shear to eps_dev >= " + fmt::format("{:g}", options.steady_from);
    return tied;
  }
  const double n = static_cast<double>(ratios.size());
  double mean = 0;
  for (const auto& [test, ratio] : ratios) mean += ratio.value() / n;
  std::map<int, double> off;  // of the mean, by what each packing added to it
  for (const auto& [test, ratio] : ratios) off[ratio.packing] += (ratio.value() - mean) / n;
  a1.value = 2. / 3 * (a2.value - mean);
  a1.status = Status::tied;
  a1.note = fmt::format("mean of A1/(B F) over steady shear of {} tests, A1 = (2/3)(A2 - sigma_dev)", ratios.size());
  if (!std::isfinite(a2.standard_error) || off.size() < 2) return tied;
  const double packings = static_cast<double>(off.size()), few = std::sqrt(packings / (packings - 1));
  tied.influence = 2. / 3 * influence_on_a2;
  for (const auto& [packing, part] : off) tied.influence(packing) -= 2. / 3 * few * part;
  a1.standard_error = tied.influence.norm();
  a1.degrees_of_freedom = std::min(a2.degrees_of_freedom, packings - 1);
  return tied;
}

}  // namespace grainlaw::fit
