#include "dem/relax.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "dem/run_watch.hpp"

namespace grainlaw::dem {
namespace {

// FIRE with the semi-implicit Euler step and the half step back of Guénolé et al., Comput. Mater. Sci. 175, 109584
// (2020). Forces are measured in units of k (they are overlaps, in m), time in units of sqrt(mass/k): the step is a
// pure number. Masses are the minimiser's own: m_i = |K_i|, K_i = sum_c n n^T, a bound of the stiffness that holds
// sphere i. Since the sum over contacts of ((u_i - u_j).n)^2 is at most twice sum_i |K_i| u_i^2, no mode is faster than
// sqrt(2) whatever the sizes, and steps up to sqrt(2) are stable.
constexpr double kFirstStep = 0.1;
constexpr double kSmallestStep = 0.01;
constexpr double kLargestStep = 1.0;
constexpr double kGrowth = 1.1, kShrink = 0.5;
constexpr double kMixing = 0.1, kMixingDecay = 0.99;
constexpr int kDelay = 10;  // passes downhill before the step grows

// Below this net force over k <r>, positions are too coarse for any criterion: an unjammed packing whose last contacts
// touch by rounding only.
constexpr double kRounding = 1e-13;

// Skin of the pairs that passes look at, over that of the list they are picked from: spheres at rest hardly move.
constexpr double kNearSkin = 0.125;
constexpr double kOfTheSkin = 0.499;  // that a sphere may move, of two that come nearer together; less rounding

/// Totals of one force pass; `f` is the net force on a sphere over k, `g` = f/sqrt(m), `w` = sqrt(m) v.
struct Totals {
  double gw = 0, gg = 0, ww = 0;  // sums of g.w, g.g, w.w
  double overlap = 0;             // sum over contact meetings (twice per contact) [m]
  double overlap2 = 0;            // likewise of its square [m^2]
  std::size_t meetings = 0;
  double f2_max = 0;              // largest f.f [m^2]
};

struct Neighbour {
  std::uint32_t j, image;  ///< as in NeighbourList
};

struct Minimiser {
  Packing& packing;
  ThreadTeam team;
  NeighbourList list;
  double near_skin;                    // [m]
  std::vector<Neighbour> near;         // of the list's neighbours of i, from first[i] on, those within near_skin, in its order
  std::vector<std::size_t> near_end;   // of these, for each sphere
  std::vector<Eigen::Vector3d> shift;  // H n of each image of the list [m]
  std::vector<Row> place;              // x, y, z, r [m]
  std::vector<Row> reference;          // x, y, z at the last rebuild of the list [m]
  std::vector<Row> near_reference;     // x, y, z when the near ones were picked [m]
  std::vector<Row> w, g;               // see Totals; [3] of w is 1/sqrt(m)
  std::vector<Totals> parts;           // one per block

  Minimiser(Packing& p, int threads, double skin) : packing(p), team(threads), near_skin(kNearSkin * skin) {
    list.skin = skin;
    place.resize(p.size());
    w.resize(p.size());
    g.resize(p.size());
    parts.resize(block_count(p.size()));
    rebuild();
    rest();
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
    near.resize(list.j.size());
    near_end.resize(packing.size());
    pick_near();
  }

  void pick_near() {
    for_each_block([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        std::size_t last = list.first[i];
        for (std::size_t c = list.first[i]; c < list.first[i + 1]; ++c) {
          const Neighbour neighbour{list.j[c], list.image[c]};
          const Row d = between(i, neighbour);
          const double reach = d[3] + near_skin;
          if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach) near[last++] = neighbour;
        }
        near_end[i] = last;
      }
    });
    near_reference = place;
  }

  /// From a neighbour to sphere i, and the sum of their radii [m].
  Row between(std::size_t i, Neighbour neighbour) const {
    const Row &pi = place[i], &pj = place[neighbour.j];
    const Eigen::Vector3d& image = shift[neighbour.image];
    return {pi[0] - pj[0] - image[0], pi[1] - pj[1] - image[1], pi[2] - pj[2] - image[2], pi[3] + pj[3]};
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

  /// Calls update(i) for each sphere, which may move it; picks the near ones again, or rebuilds the list, when one has gone too
  /// far.
  template <class Update>
  void move(const Update& update) {
    std::vector<double> moved2(parts.size()), near_moved2(parts.size());
    const auto distance2 = [](const Row& a, const Row& b) {
      double d2 = 0;
      for (std::size_t k = 0; k < 3; ++k) d2 += (a[k] - b[k]) * (a[k] - b[k]);
      return d2;
    };
    for_each_block([&](std::size_t block, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        update(i);
        moved2[block] = std::max(moved2[block], distance2(place[i], reference[i]));
        near_moved2[block] = std::max(near_moved2[block], distance2(place[i], near_reference[i]));
      }
    });
    const auto farthest = [](const std::vector<double>& d2) { return std::sqrt(*std::max_element(d2.begin(), d2.end())); };
    if (!(farthest(moved2) < allowed_displacement(list, packing.H, packing.H))) {
      store();
      rebuild();
    } else if (!(farthest(near_moved2) < kOfTheSkin * near_skin)) {
      pick_near();
    }
  }

  /// Calls visit(j, dx, dy, dz, d, delta) for each contact of sphere i.
  template <class Visit>
  void visit_contacts(std::size_t i, const Visit& visit) const {
    for (std::size_t c = list.first[i]; c < near_end[i]; ++c) {
      const auto [dx, dy, dz, reach] = between(i, near[c]);
      const double d2 = dx * dx + dy * dy + dz * dz;
      if (!(d2 < reach * reach)) continue;
      const double d = std::sqrt(d2);
      if (!std::isfinite(dx / d + dy / d + dz / d)) {  // at zero distance, or where its square underflows
        throw Error(fmt::format("spheres {} and {} share one position; move one of them", packing.id[i],
                                packing.id[near[c].j]));
      }
      visit(dx / d, dy / d, dz / d, reach - d);
    }
  }

  /// Stops the spheres and gives them the masses of their present contacts; at least the one of a single contact.
  void rest() {
    for_each_block([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        double xx = 0, yy = 0, zz = 0, yz = 0, xz = 0, xy = 0;
        visit_contacts(i, [&](double nx, double ny, double nz, double) {
          xx += nx * nx, yy += ny * ny, zz += nz * nz, yz += ny * nz, xz += nx * nz, xy += nx * ny;
        });
        yz = std::abs(yz), xz = std::abs(xz), xy = std::abs(xy);
        const double mass = std::max({1.0, xx + xy + xz, xy + yy + yz, xz + yz + zz});  // largest row sum
        w[i] = {0, 0, 0, 1 / std::sqrt(mass)};
      }
    });
  }

  Totals forces() {
    for_each_block([&](std::size_t block, std::size_t begin, std::size_t end) { parts[block] = block_forces(begin, end); });
    Totals sum;
    for (const Totals& part : parts) {
      sum.gw += part.gw;
      sum.gg += part.gg;
      sum.ww += part.ww;
      sum.overlap += part.overlap;
      sum.overlap2 += part.overlap2;
      sum.meetings += part.meetings;
      sum.f2_max = std::max(sum.f2_max, part.f2_max);
    }
    return sum;
  }

  Totals block_forces(std::size_t begin, std::size_t end) {
    Totals sum;
    for (std::size_t i = begin; i < end; ++i) {
      double fx = 0, fy = 0, fz = 0;
      visit_contacts(i, [&](double nx, double ny, double nz, double delta) {
        fx += delta * nx;
        fy += delta * ny;
        fz += delta * nz;
        sum.overlap += delta;
        sum.overlap2 += delta * delta;
        ++sum.meetings;
      });
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
  if (totals.gw < 0) {  // uphill: half a step back, rest, and on with new forces
    const double back = 0.5 * pacing.dt;
    m.move([&](std::size_t i) {
      for (std::size_t a = 0; a < 3; ++a) m.place[i][a] -= back * m.w[i][a] * m.w[i][3];
    });
    m.rest();
    pacing = {std::max(kSmallestStep, pacing.dt * kShrink), kMixing, 0};
    return;
  }
  if (++pacing.downhill > kDelay) {
    pacing.dt = std::min(kLargestStep, pacing.dt * kGrowth);
    pacing.mixing *= kMixingDecay;
  }
  // w + dt g, turned towards g: its length is known from the totals
  const double dt = pacing.dt;
  const double w2 = totals.ww + 2 * dt * totals.gw + dt * dt * totals.gg;
  const double keep = 1 - pacing.mixing, along = pacing.mixing * std::sqrt(w2 / totals.gg);
  m.move([&](std::size_t i) {
    for (std::size_t a = 0; a < 3; ++a) {
      m.w[i][a] = keep * (m.w[i][a] + dt * m.g[i][a]) + along * m.g[i][a];
      m.place[i][a] += dt * m.w[i][a] * m.w[i][3];
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
  RunWatch watch(control, "relaxation", "force passes");
  Minimiser minimiser(packing, engine.threads, engine.skin * mean_radius(packing));
  const double rounding = kRounding * k * mean_radius(packing);
  Pacing pacing;
  double first_ratio = 0;
  for (;;) {
    const Totals totals = minimiser.forces();
    ++result.passes;
    result.E_after = 0.25 * k * totals.overlap2;  // k delta^2/2 of each contact
    if (result.passes == 1) result.E_before = result.E_after;
    result.max_net_force = k * std::sqrt(totals.f2_max);
    result.mean_contact_force = totals.meetings ? k * totals.overlap / static_cast<double>(totals.meetings) : 0;
    if (!std::isfinite(result.max_net_force)) throw Error("relaxation: forces are no longer finite");
    result.relaxed = result.max_net_force <= std::max(options.tolerance * result.mean_contact_force, rounding);
    if (result.relaxed || result.passes >= options.max_passes) break;
    const double ratio = result.max_net_force / result.mean_contact_force;
    if (first_ratio == 0) first_ratio = ratio;
    watch.tick(fraction_done(ratio, first_ratio, options.tolerance), static_cast<double>(result.passes));
    iterate(minimiser, totals, pacing);
  }
  minimiser.store();
  wrap(packing);
  forget_motion(state);
  return result;
}

}  // namespace grainlaw::dem
