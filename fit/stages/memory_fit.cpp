#include "fit/stages/memory_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <map>

#include "fit/stages/evolution_fit.hpp"
#include "fit/stages/trajectory_misfit.hpp"

namespace grainlaw::fit {
namespace {

/// Free ones. The last two act only where the volume of a sheared state changes.
constexpr std::array kFree{"memory.G",   "memory.alpha", "memory.k",   "memory.lambda",
                           "memory.chi", "memory.kappa", "memory.c_F", "memory.a2"};
constexpr std::size_t kVolumetric = 2;
constexpr double kVagueParameter = 0.5;  // relative error beyond which a parameter is no number, chance aside
constexpr double kWindowRounding = 1e-9;
constexpr double kNoLode = 1e-6;  // of D2, by rounding

/// Rows of a channel that count.
struct Counted {
  double window;        ///< deviatoric strain up to which they do; together they weigh 1/scale
  bool beyond = false;  ///< the others, too; together they weigh as much
};

/// Mean P* of the rows. Weights by each row's own P* would be larger where its noise makes it small, and the law too low.
double mean_pressure(const Trajectory& t) {
  double sum = 0;
  for (const TrajectoryRow& row : t.rows) sum += row.data.P;
  return sum / static_cast<double>(t.rows.size());
}

/// Adds a quantity as one channel.
void add_channel(const Trajectory& t, const std::string& quantity, Counted counted, ResidualBlock& block,
                 double (*datum)(const Trajectory&, const LawState<double>&), double scale) {
  const int rows = static_cast<int>(t.rows.size()), first = rows * static_cast<int>(block.channels.size());
  const auto in = [&](const TrajectoryRow& row) { return t.direction.de * row.e <= counted.window + kWindowRounding; };
  const auto inside = std::count_if(t.rows.begin(), t.rows.end(), in), outside = rows - inside;
  Channel channel{quantity, first, rows, t.excluded, 0};
  for (int i = 0; i < rows; ++i) {
    const TrajectoryRow& row = t.rows[static_cast<std::size_t>(i)];
    channel.max_abs_data = std::max(channel.max_abs_data, std::abs(datum(t, row.data)));
    if (in(row) || counted.beyond)
      block.weight(first + i) = 1 / (std::sqrt(static_cast<double>(in(row) ? inside : outside)) * scale);
  }
  block.channels.push_back(channel);
}

ResidualBlock memory_block(const Trajectory& t, const LawParameters<double>& fixed,
                           const std::vector<std::size_t>& index, const CalibrationOptions& options) {
  constexpr Counted all{1e300}, none{-1};
  const bool shear = t.constant_volume();
  ResidualBlock block;
  block.test = t.test;
  block.cluster = t.cluster;
  block.weight = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(t.rows.size()));
  add_channel(
      t, "P_star", shear ? all : none, block, [](const Trajectory&, const LawState<double>& y) { return y.P; },
      options.pressure_scale * mean_pressure(t));
  add_channel(
      t, "s_par", shear ? Counted{options.stiffness_window, true} : all, block,
      [](const Trajectory& of, const LawState<double>& y) { return y.sigma.dot(of.axes.front()) / y.P; },
      options.stress_scale);
  add_channel(
      t, "F_par", shear ? Counted{options.lag_window} : all, block,
      [](const Trajectory& of, const LawState<double>& y) { return y.F.dot(of.axes.front()); }, options.fabric_scale);
  block.evaluate = differentiated({t, fixed, index, Rung::memory, Coupling::energy, options.max_step, 1});
  return block;
}

/// The trajectories, each as dense as the law would have to be to carry at the start of the test what its packing carries,
/// beside the mean of the packings whose tests start at the same density of the same branch. Packings differ in their
/// jamming density, and shear does not undo that; at one density for all, the law takes it for a state that relaxes, and
/// what it does then is not linear: many packings do not find the law of their mean.
std::vector<Trajectory> at_own_densities(std::vector<Trajectory> all, const LawParameters<double>& law) {
  struct Start {
    const Trajectory* of;
    double compression;  // ln of the density at which the law's reference carries its P over its nu
  };
  std::vector<Start> starts;
  for (const Trajectory& t : all) {
    if (t.segment > 0 || t.axes.empty() || !(t.start.P > 0)) continue;
    const double nu_P = pressure_density(memory_moduli(law, t.nu_start), t.start.P);
    starts.push_back({&t, std::log(nu_P / t.nu_start)});
  }
  std::map<std::string, double> factor;
  for (const Start& own : starts) {
    std::map<int, double> of_packings;
    for (const Start& other : starts) {
      if (own.of->branch == other.of->branch && std::abs(own.of->nu_start - other.of->nu_start) < kSameDensity)
        of_packings[other.of->cluster] = other.compression;
    }
    double mean = 0;
    for (const auto& [packing, compression] : of_packings)
      mean += compression / static_cast<double>(of_packings.size());
    factor[own.of->test] = std::exp(own.compression - mean);
  }
  for (Trajectory& t : all) {
    if (const auto found = factor.find(t.test); found != factor.end()) t.nu_start *= found->second;
  }
  return all;
}

/// Whether none of the fabric may lag, kappa being on its bound or within its 95 % interval of it: then the rate lambda at which it
/// follows need not be known.
bool lag_may_be_none(const StageFit& fit) {
  const Eigen::Index at = fit.find("memory.kappa");
  if (at < 0) return false;
  const Estimate& kappa = fit.stage.estimates[static_cast<std::size_t>(at)].estimate;
  const double half = std::isnan(kappa.half_width()) ? 0 : kappa.half_width();  // none on a bound
  return kappa.value + half >= parameter_table()[parameter_index("memory.kappa")].upper;
}

/// Lower end of the 95 % interval of a standard error, over it: with two packings an error is chance by a factor of two.
double least_of_error(double degrees_of_freedom) {
  return std::sqrt(degrees_of_freedom / boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), 0.975));
}

void withdraw_vague(StageFit& fit) {
  const bool may_not_lag = lag_may_be_none(fit);
  for (std::size_t k = 0; k < fit.stage.estimates.size(); ++k) {
    const std::string name = fit.stage.estimates[k].name;
    const Estimate& e = fit.stage.estimates[k].estimate;
    const bool may_be_vague = name == "memory.chi" || name == "memory.kappa" ||  // both may be none
                              (name == "memory.lambda" && may_not_lag);
    const double relative = e.standard_error / std::abs(e.value);
    if (may_be_vague || !(relative > kVagueParameter) ||
        !(relative * least_of_error(e.degrees_of_freedom) > kVagueParameter))
      continue;
    const bool volumetric = k >= kFree.size() - kVolumetric;
    fit.mark_not_identified(name, fmt::format("its error is {:.2g} of its value; ", relative) +
                                      (volumetric ? kChangeTheVolume : "add seeds and lower densities"));
  }
}

std::string memory_window(const CalibrationOptions& options) {
  return fmt::format(
      "all trajectories with shear, each segment from its measured start and each packing at its own density: at "
      "constant volume, of the rows of evolution, P* relative to the mean, scale {:g}, s_par of eps_dev <= {:g} and "
      "with the same weight of the rest, scale {:g}, F_par of eps_dev <= {:g}, scale {:g}; where the volume changes "
      "s_par and F_par of all rows",
      options.pressure_scale, options.stiffness_window, options.stress_scale, options.lag_window, options.fabric_scale);
}

}  // namespace

StageDefinition memory_stage(const std::vector<Trajectory>& trajectories, const CalibrationOptions& options) {
  StageDefinition stage;
  stage.name = "memory";
  stage.window = memory_window(options);
  stage.free.assign(kFree.begin(), kFree.end());
  if (!contains_anisotropy(trajectories)) {
    stage.free.resize(kFree.size() - kVolumetric);
    for (std::size_t k = stage.free.size(); k < kFree.size(); ++k)
      stage.absent.push_back({kFree[k], {0, kUndefined, Status::not_identified, kChangeTheVolume}});
  }
  stage.remedy = "the trajectories do not determine it; shear at more and at lower densities";
  stage.blocks = [=, free = stage.free](const LawParameters<double>& law) {
    std::vector<std::size_t> index;
    for (const std::string& name : free) index.push_back(parameter_index(name));
    std::vector<ResidualBlock> blocks;
    for (const Trajectory& t : at_own_densities(trajectories, law)) {
      if (!t.axes.empty() && !t.rows.empty()) blocks.push_back(memory_block(t, law, index, options));
    }
    return blocks;
  };
  stage.given = {"coordination",    "rattlers",        "pressure",         "steady_coordination",
                 "steady_rattlers", "steady_pressure", "stress_ratio_max", "fabric_max"};
  if (std::ranges::any_of(trajectories, [](const Trajectory& t) { return std::abs(t.direction.lode) > kNoLode; }))
    stage.given.push_back("lode");
  stage.judge = [](StageFit& fit, const LawParameters<double>&) { withdraw_vague(fit); };
  stage.coupled = stage.profiled = true;
  return stage;
}

StageDefinition no_memory(const std::string& remedy) {
  return left_out("memory", {kFree.begin(), kFree.end()}, remedy);
}

}  // namespace grainlaw::fit
