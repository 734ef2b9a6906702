#include "fit/stages/density_fit.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace grainlaw::fit {
namespace {

constexpr double kStartBelowData = 0.005;  // at least, of a jamming density, whatever it was before

using Jet3 = ceres::Jet<double, 3>;
using Jet2 = ceres::Jet<double, 2>;
using Jet1 = ceres::Jet<double, 1>;

/// One block per series; `datum` is what the model is compared with, for the scale of the report only.
template <class Jet, class Misfit, class Datum>
std::vector<ResidualBlock> blocks_of(const std::vector<DensitySeries>& series, const std::string& quantity,
                                     int parameters, const Misfit& misfit, const Datum& datum) {
  std::vector<ResidualBlock> blocks;
  for (const DensitySeries& s : series) {
    const int rows = static_cast<int>(s.points.size());
    ResidualBlock block;
    block.test = s.test;
    block.cluster = s.cluster;
    block.weight = Eigen::VectorXd::Ones(rows);
    Channel channel{quantity, 0, rows, s.excluded, 0};
    for (const DensityPoint& p : s.points) channel.max_abs_data = std::max(channel.max_abs_data, std::abs(datum(p)));
    block.channels.push_back(channel);
    block.evaluate = differentiated<Jet>(
        [points = s.points, misfit](const auto* x, auto* values) {
          for (std::size_t i = 0; i < points.size(); ++i) values[i] = misfit(points[i], x);
          return true;
        },
        parameters, rows);
    blocks.push_back(std::move(block));
  }
  return blocks;
}

std::vector<double> densities(const std::vector<DensitySeries>& series) {
  std::vector<double> nu;
  for (const DensitySeries& s : series) {
    for (const DensityPoint& p : s.points) nu.push_back(p.nu);
  }
  return nu;
}

/// What a stage says of its parameters when there are too few densities.
std::function<void(StageFit&, const LawParameters<double>&)> require_densities(const std::vector<DensitySeries>& series,
                                                                               int needed) {
  return [found = distinct_densities(densities(series)), needed](StageFit& fit, const LawParameters<double>&) {
    if (found >= needed) return;
    for (const NamedEstimate& p : std::vector<NamedEstimate>(fit.stage.estimates))
      fit.mark_not_identified(p.name, fmt::format("{} of at least {} densities; test more densities", found, needed));
  };
}

/// A stage of rows of `series`; free are the parameters of `group`.
StageDefinition density_stage(const std::string& name, const std::string& group, const std::string& window,
                              const std::vector<DensitySeries>& series) {
  StageDefinition stage;
  stage.name = name;
  stage.window = window + ", rows unweighted";
  stage.free = parameters_of(group);
  stage.remedy = "the rows do not determine it; test more densities";
  stage.least_nu = least_nu(series);
  return stage;
}

/// Likewise, of one of the three laws of a state law.
StageDefinition state_law_stage(const StateLawName& of, const std::string& law, const std::string& window,
                                const std::vector<DensitySeries>& series) {
  StageDefinition stage = density_stage(of.prefix + law, of.prefix + law, window, series);
  stage.profiled = true;
  return stage;
}

StageDefinition coordination_stage(const StateLawName& of, const std::vector<DensitySeries>& series,
                                   const std::string& window) {
  StageDefinition stage = state_law_stage(of, "coordination", window, series);
  stage.start = [of, highest = stage.least_nu - kStartBelowData](LawParameters<double>& law) {
    double& nu_c = (law.*of.law).coordination.nu_c;
    nu_c = std::min(nu_c, highest);
  };
  stage.blocks = [series](const LawParameters<double>&) {
    return blocks_of<Jet3>(
        series, "C_star", 3,
        [](const DensityPoint& p, const auto* x) {
          using T = std::decay_t<decltype(*x)>;
          return Coordination<T>{x[0], x[1], x[2]}.C_star(p.nu) - p.C_star;
        },
        [](const DensityPoint& p) { return p.C_star; });
  };
  stage.judge = require_densities(series, 3);
  return stage;
}

StageDefinition rattlers_stage(const StateLawName& of, const std::vector<DensitySeries>& series,
                               const std::string& window) {
  StageDefinition stage = state_law_stage(of, "rattlers", window, series);
  stage.blocks = [of, series](const LawParameters<double>& law) {
    return blocks_of<Jet2>(
        series, "rattler_fraction", 2,
        [nu_c = (law.*of.law).coordination.nu_c](const DensityPoint& p, const auto* x) {
          using T = std::decay_t<decltype(*x)>;
          return Rattlers<T>{x[0], x[1]}.fraction(p.nu, T(nu_c)) - p.rattler_fraction;
        },
        [](const DensityPoint& p) { return p.rattler_fraction; });
  };
  stage.given = {of.prefix + std::string("coordination.nu_c")};
  stage.judge = require_densities(series, 2);
  return stage;
}

/// Eq. (15) over its nu_c, times that of the start; `C_of` says the contacts at a jamming density and point.
template <class ContactsOf>
std::vector<ResidualBlock> pressure_blocks(const std::vector<DensitySeries>& series, double start,
                                           const ContactsOf& C_of) {
  const auto measured = [=](const DensityPoint& p) { return start * p.P_star / (p.nu * C_of(start, p)); };
  return blocks_of<Jet3>(
      series, "P_scaled", 3,
      [=](const DensityPoint& p, const auto* x) {
        using T = std::decay_t<decltype(*x)>;
        const T scale = start * C_of(x[2], p) / (x[2] * C_of(start, p));
        return Pressure<T>{x[0], x[1], x[2]}.scaled(p.nu) * scale - measured(p);
      },
      measured);
}

StageDefinition pressure_stage(const StateLawName& of, const std::vector<DensitySeries>& series,
                               const std::string& window) {
  StageDefinition stage = state_law_stage(of, "pressure", window, series);
  stage.start = [of, highest = stage.least_nu - kStartBelowData](LawParameters<double>& law) {
    double& nu_c = (law.*of.law).pressure.nu_c;
    nu_c = std::min(nu_c, highest);
  };
  stage.blocks = [of, series](const LawParameters<double>& law) {
    return pressure_blocks(series, (law.*of.law).pressure.nu_c,
                           [](const auto&, const DensityPoint& p) { return p.C(); });
  };
  stage.judge = require_densities(series, 3);
  return stage;
}

}  // namespace

StageDefinition pressure_of_assumed_contacts(const StateLawName& of, const std::vector<DensitySeries>& series,
                                             const std::string& window) {
  StageDefinition stage = pressure_stage(of, series, window);
  stage.window += "; C by Eqs. (11), (12) as published, from the nu_c of the pressure on";
  stage.blocks = [of, series](const LawParameters<double>& law) {
    return pressure_blocks(series, (law.*of.law).pressure.nu_c,
                           [assumed = law.*of.law](const auto& nu_c, const DensityPoint& p) {
                             using T = std::decay_t<decltype(nu_c)>;
                             const Coordination<double>& c = assumed.coordination;
                             const Rattlers<double>& r = assumed.rattlers;
                             return StateLaw<T>{{T(c.C1), T(c.alpha), nu_c}, {T(r.phi_c), T(r.phi_v)}, {}}.C(p.nu);
                           });
  };
  return stage;
}

std::vector<StageDefinition> state_law_stages(const StateLawName& of, const std::vector<DensitySeries>& series,
                                              const std::string& window) {
  return {coordination_stage(of, series, window), rattlers_stage(of, series, window),
          pressure_stage(of, series, window)};
}

std::vector<StageDefinition> left_out_state_law(const StateLawName& of, const std::string& remedy) {
  std::vector<StageDefinition> stages;
  for (const std::string law : {"coordination", "rattlers", "pressure"})
    stages.push_back(left_out(of.prefix + law, parameters_of(of.prefix + law), remedy));
  return stages;
}

StageDefinition overlap_stage(const std::vector<DensitySeries>& series, const std::string& window) {
  for (const DensitySeries& s : series) {
    if (std::any_of(s.points.begin(), s.points.end(),
                    [](const DensityPoint& p) { return std::isnan(p.mean_overlap); })) {
      return left_out("overlap", parameters_of("overlap"),
                      "test " + s.test + " lacks values of mean_overlap; add the column");
    }
  }
  StageDefinition stage = density_stage("overlap", "overlap", window, series);
  stage.window += ", nu_c of the pressure";
  stage.blocks = [series](const LawParameters<double>& law) {
    return blocks_of<Jet1>(
        series, "mean_overlap", 1,
        [nu_c = law.isotropic.pressure.nu_c](const DensityPoint& p, const auto* x) {
          return x[0] * std::log(p.nu / nu_c) - p.mean_overlap;
        },
        [](const DensityPoint& p) { return p.mean_overlap; });
  };
  stage.given = {"pressure.nu_c"};
  return stage;
}

StageDefinition fabric_trace_stage(const std::vector<DensitySeries>& all, const std::string& window) {
  std::vector<DensitySeries> series = with_contacts(all);
  std::erase_if(series, [](const DensitySeries& s) { return std::isnan(s.points.front().F_v); });
  if (series.empty())
    return left_out("fabric_trace", parameters_of("fabric"), with_contacts(all).empty() ? kAddContacts : kAddFabric);
  StageDefinition stage = density_stage("fabric_trace", "fabric", window, series);
  stage.window += ", measured C";
  stage.blocks = [series](const LawParameters<double>&) {
    return blocks_of<Jet1>(
        series, "F_v", 1, [](const DensityPoint& p, const auto* x) { return x[0] * (p.nu * p.C()) - p.F_v; },
        [](const DensityPoint& p) { return p.F_v; });
  };
  return stage;
}

}  // namespace grainlaw::fit
