#include "dem/relax.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "dem/run_watch.hpp"

namespace grainlaw::dem {
namespace {

// FIRE with the semi-implicit Euler step and the half step back of Guénolé et al., Comput. Mater. Sci. 175, 109584
// (2020). Forces are measured in units of k (they are overlaps, in m) and the minimiser's time in units of
// sqrt(mass/k), so that the step is a pure number.
constexpr double kFirstStep = 0.1;
constexpr double kSmallestStep = 0.002;
constexpr double kLargestStep = 0.6;
constexpr double kGrowth = 1.1, kShrink = 0.5;
constexpr double kMixing = 0.25, kMixingDecay = 0.99;
constexpr int kDelay = 20;  // passes downhill before the step grows

/// Totals of one force pass; `f` is the net force on a sphere over k, `g` = f/sqrt(m), `w` = sqrt(m) v.
struct Totals {
  double gw = 0, gg = 0, ww = 0;  ///< sums of g.w, g.g, w.w
  double overlap = 0;             ///< sum over contact meetings (twice per contact) [m]
  std::size_t meetings = 0;
  double f2_max = 0;              ///< largest f.f [m^2]
};

struct Minimiser {
  Packing& packing;
  ThreadTeam team;
  NeighbourList list;
  std::vector<Eigen::Vector3d> shift;  ///< H n of each image of the list [m]
  std::vector<Row> place;              ///< x, y, z, r [m]
  std::vector<Row> reference;          ///< x, y, z at the last rebuild of the list [m]
  std::vector<Row> w, g;               ///< see Totals; [3] of w is 1/sqrt(m)
  std::vector<Totals> parts;           ///< one per block

  Minimiser(Packing& p, int threads, double skin) : packing(p), team(threads) {
    list.skin = skin;
    place.resize(p.size());
    w.resize(p.size());
    g.resize(p.size());
    parts.resize(block_count(p.size()));
    // A sphere's stiffness grows with its number of contacts, hence with its surface: mass ~ r evens out the
    // frequencies of small and large spheres.
    const double mean = mean_radius(p);
    for (std::size_t i = 0; i < p.size(); ++i) w[i] = {0, 0, 0, std::sqrt(mean / p.radius[i])};
    rebuild();
  }

  template <class Body>
  void for_each_block(const Body& body) {
    team.for_each_block(parts.size(), [&](std::size_t block) {
      body(block, block * kBlockSize, std::min(packing.size(), (block + 1) * kBlockSize));
    });
  }

  void rebuild() {
    wrap(packing);
    list = build_list(packing, list.skin, team);
    shift.clear();
    for (const Eigen::Vector3d& n : list.offset) shift.push_back(packing.H * n);
    for (std::size_t i = 0; i < packing.size(); ++i) {
      const Eigen::Vector3d x = packing.H * Eigen::Vector3d(packing.sx[i], packing.sy[i], packing.sz[i]);
      place[i] = {x[0], x[1], x[2], packing.radius[i]};
    }
    reference = place;
  }

  /// Positions back into the fractions of the packing.
  void store() {
    const Eigen::Matrix3d inverse = packing.H.inverse();
    for (std::size_t i = 0; i < packing.size(); ++i) {
      const Eigen::Vector3d s = inverse * Eigen::Vector3d(place[i][0], place[i][1], place[i][2]);
      packing.sx[i] = s[0];
      packing.sy[i] = s[1];
      packing.sz[i] = s[2];
    }
  }

  /// Adds a/sqrt(m) * w to the positions; rebuilds the list when a sphere has gone too far.
  template <class Update>
  void move(const Update& update) {
    std::vector<double> moved2(parts.size());
    for_each_block([&](std::size_t block, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        update(i);
        double d2 = 0;
        for (std::size_t a = 0; a < 3; ++a) {
          const double d = place[i][a] - reference[i][a];
          d2 += d * d;
        }
        moved2[block] = std::max(moved2[block], d2);
      }
    });
    const double farthest = std::sqrt(*std::max_element(moved2.begin(), moved2.end()));
    if (!(farthest < allowed_displacement(list, packing.H, packing.H))) {
      store();
      rebuild();
    }
  }

  Totals forces() {
    for_each_block([&](std::size_t block, std::size_t begin, std::size_t end) { parts[block] = block_forces(begin, end); });
    Totals sum;
    for (const Totals& part : parts) {
      sum.gw += part.gw;
      sum.gg += part.gg;
      sum.ww += part.ww;
      sum.overlap += part.overlap;
      sum.meetings += part.meetings;
      sum.f2_max = std::max(sum.f2_max, part.f2_max);
    }
    return sum;
  }

  Totals block_forces(std::size_t begin, std::size_t end) {
    Totals sum;
    for (std::size_t i = begin; i < end; ++i) {
      const Row& pi = place[i];
      double fx = 0, fy = 0, fz = 0;
      for (std::size_t c = list.first[i]; c < list.first[i + 1]; ++c) {
        const Row& pj = place[list.j[c]];
        const Eigen::Vector3d& image = shift[list.image[c]];
        const double dx = pi[0] - pj[0] - image[0], dy = pi[1] - pj[1] - image[1], dz = pi[2] - pj[2] - image[2];
        const double reach = pi[3] + pj[3];
        const double d2 = dx * dx + dy * dy + dz * dz;
        if (!(d2 < reach * reach)) continue;
        const double d = std::sqrt(d2);
        const double delta = reach - d;
        const double scale = delta / d;
        if (!std::isfinite(scale * dx + scale * dy + scale * dz)) {
          throw Error(fmt::format("spheres {} and {} share one position; move one of them", packing.id[i],
                                  packing.id[list.j[c]]));
        }
        fx += scale * dx;
        fy += scale * dy;
        fz += scale * dz;
        sum.overlap += delta;
        ++sum.meetings;
      }
      const Row& wi = w[i];
      const double inverse = wi[3];
      g[i] = {fx * inverse, fy * inverse, fz * inverse, 0};
      const double f2 = fx * fx + fy * fy + fz * fz;
      sum.f2_max = std::max(sum.f2_max, f2);
      sum.gg += f2 * inverse * inverse;
      sum.gw += g[i][0] * wi[0] + g[i][1] * wi[1] + g[i][2] * wi[2];
      sum.ww += wi[0] * wi[0] + wi[1] * wi[1] + wi[2] * wi[2];
    }
    return sum;
  }
};

/// Step and mixing of FIRE between passes.
struct Pacing {
  double dt = kFirstStep;
  double mixing = kMixing;
  int downhill = 0;
};

/// One FIRE iteration from the forces that `totals` belongs to.
void iterate(Minimiser& m, const Totals& totals, Pacing& pacing) {
  const bool uphill = totals.gw < 0;
  double back = 0;
  if (uphill) {
    back = 0.5 * pacing.dt;
    pacing = {std::max(kSmallestStep, pacing.dt * kShrink), kMixing, 0};
  } else if (++pacing.downhill > kDelay) {
    pacing.dt = std::min(kLargestStep, pacing.dt * kGrowth);
    pacing.mixing *= kMixingDecay;
  }
  const double dt = pacing.dt;
  const double w2 = uphill ? dt * dt * totals.gg : totals.ww + 2 * dt * totals.gw + dt * dt * totals.gg;
  const double along = totals.gg > 0 ? pacing.mixing * std::sqrt(std::max(0.0, w2) / totals.gg) : 0;
  const double keep = 1 - pacing.mixing;
  m.move([&](std::size_t i) {
    Row& wi = m.w[i];
    const Row& gi = m.g[i];
    for (std::size_t a = 0; a < 3; ++a) {
      const double before = uphill ? 0 : wi[a];
      const double after = keep * (before + dt * gi[a]) + along * gi[a];
      m.place[i][a] += (dt * after - back * wi[a]) * wi[3];
      wi[a] = after;
    }
  });
}

double fraction_done(double ratio, double first_ratio, double tolerance) {
  const double all = std::log(first_ratio / tolerance), done = std::log(first_ratio / ratio);
  return all > 0 && std::isfinite(done) ? std::clamp(done / all, 0.0, 1.0) : 0;
}

void forget_motion(State& state) {
  for (auto* v : {&state.packing.vx, &state.packing.vy, &state.packing.vz}) std::fill(v->begin(), v->end(), 0.0);
  for (auto* a : {&state.ax, &state.ay, &state.az, &state.ref_x, &state.ref_y, &state.ref_z}) a->clear();
  state.ref_H.setZero();
  state.sums = {};
  state.ledger = {};
  state.step = 0;
  state.time = 0;
}

}  // namespace

Relaxation relax(State& state, const EngineOptions& engine, const RelaxOptions& options, const RunControl& control) {
  if (!(options.tolerance > 0)) throw InvalidInput("relax tolerance: must be positive");
  if (options.max_passes < 1) throw InvalidInput("relax max_passes: must be at least 1");
  Packing& packing = state.packing;
  check(packing);
  Relaxation result;
  if (packing.size() == 0) {
    forget_motion(state);
    result.relaxed = true;
    return result;
  }
  if (!(engine.skin > 0) || !std::isfinite(engine.skin)) throw InvalidInput("skin: must be positive and finite");
  const double k = state.material.stiffness;
  RunWatch watch(control, "relaxation", "particle-steps");
  Minimiser minimiser(packing, engine.threads, engine.skin * mean_radius(packing));
  Pacing pacing;
  double first_ratio = 0;
  for (;;) {
    const Totals totals = minimiser.forces();
    ++result.passes;
    result.max_net_force = k * std::sqrt(totals.f2_max);
    result.mean_contact_force = totals.meetings ? k * totals.overlap / static_cast<double>(totals.meetings) : 0;
    if (!std::isfinite(result.max_net_force)) throw Error("relaxation: forces are no longer finite");
    result.relaxed = result.max_net_force <= options.tolerance * result.mean_contact_force;
    if (result.relaxed || result.passes >= options.max_passes) break;
    const double ratio = result.max_net_force / result.mean_contact_force;
    if (first_ratio == 0) first_ratio = ratio;
    watch.tick(fraction_done(ratio, first_ratio, options.tolerance),
               static_cast<double>(result.passes) * static_cast<double>(packing.size()));
    iterate(minimiser, totals, pacing);
  }
  minimiser.store();
  wrap(packing);
  forget_motion(state);
  return result;
}

}  // namespace grainlaw::dem
