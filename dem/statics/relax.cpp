#include "dem/statics/relax.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <vector>

#include "dem/engine/run_watch.hpp"
#include "dem/statics/relax_pass.hpp"

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

constexpr std::size_t kGroupsOfBlock = kBlockSize / kLanes;
constexpr std::uint32_t kRowSize = sizeof(Row);

constexpr double kFarAway = 1e150;  // [m]; its square is finite

/// Totals of one force pass; `f` is the net force on a sphere over k, `g` = f/sqrt(m), `w` = sqrt(m) v.
struct Totals {
  double gw = 0, gg = 0, ww = 0;  // sums of g.w, g.g, w.w
  OverlapSums contacts;
  double f2_max = 0;  // largest f.f [m^2]
};

struct Minimiser {
  Packing& packing;
  ThreadTeam team;
  NeighbourList list;
  double near_skin;  // [m]
  RelaxField field;  // tiers: of the list's neighbours those within near_skin, in its order; w, g: see Totals
  std::vector<std::uint32_t> lane;  // of each sphere
  std::vector<Row> reference;       // x, y, z at the last rebuild of the list [m]
  std::vector<Row> near_reference;  // x, y, z when the near ones were picked [m]
  std::vector<Totals> parts;        // one per block

  Minimiser(Packing& p, int threads, double skin) : packing(p), team(threads), near_skin(kNearSkin * skin) {
    if (p.size() >= std::numeric_limits<std::uint32_t>::max() / kRowSize) throw InvalidInput("relax: too many spheres");
    list.skin = skin;
    field.place.assign(p.size() + 1, {kFarAway, kFarAway, kFarAway, 0});
    field.w.resize(p.size() + 1);
    field.g.resize(p.size() + 1);
    lane.resize(p.size());
    parts.resize(block_count(p.size()));
    field.sphere.resize(parts.size() * kBlockSize);
    field.first_tier.resize(groups());
    field.tiers.resize(groups());
    rebuild();
    rest();
  }

  std::size_t groups() const { return parts.size() * kGroupsOfBlock; }

  template <class Body>
  void for_each_block(const Body& body) {
    team.for_each_block(parts.size(), [&](std::size_t block) {
      body(block, block * kBlockSize, std::min(packing.size(), (block + 1) * kBlockSize));
    });
  }

  void rebuild() {
    wrap(packing);
    list = build_list(packing, list.skin, team);
    field.shift.assign(list.offset.empty() ? 1 : 0, Row{});
    for (const Eigen::Vector3d& n : list.offset) {
      const Eigen::Vector3d image = packing.H * n;
      field.shift.push_back({image[0], image[1], image[2], 0});
    }
    for (std::size_t i = 0; i < packing.size(); ++i) {
      const Eigen::Vector3d x = packing.H * Eigen::Vector3d(packing.sx[i], packing.sy[i], packing.sz[i]);
      field.place[i] = {x[0], x[1], x[2], packing.radius[i]};
    }
    reference = field.place;
    std::size_t tiers = 0;
    for (std::size_t block = 0; block < parts.size(); ++block) {
      field.first_tier[block * kGroupsOfBlock] = tiers;
      tiers += most_tiers(block);
    }
    field.tier.resize(tiers);
    pick_near();
  }

  /// That the near ones of a block can take, sorted by their numbers.
  std::size_t most_tiers(std::size_t block) const {
    std::vector<std::size_t> count;
    for (std::size_t i = block * kBlockSize; i < std::min(packing.size(), (block + 1) * kBlockSize); ++i)
      count.push_back(list.first[i + 1] - list.first[i]);
    std::sort(count.begin(), count.end(), std::greater<>());
    std::size_t tiers = 0;
    for (std::size_t rank = 0; rank < count.size(); rank += kLanes) tiers += count[rank];
    return tiers;
  }

  void pick_near() {
    for_each_block([&](std::size_t block, std::size_t begin, std::size_t end) { pick_near_of(block, begin, end); });
    near_reference = field.place;
  }

  void pick_near_of(std::size_t block, std::size_t begin, std::size_t end) {
    std::vector<std::size_t> near;  // entries of the list, sphere by sphere
    std::array<std::size_t, kBlockSize + 1> first{};
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t c = list.first[i]; c < list.first[i + 1]; ++c) {
        const Row d = between(i, list.j[c], list.image[c]);
        const double reach = d[3] + near_skin;
        if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach) near.push_back(c);
      }
      first[i - begin + 1] = near.size();
    }
    const auto count = [&](std::size_t k) { return first[k + 1] - first[k]; };
    std::array<std::size_t, kBlockSize> order;
    const auto last = order.begin() + static_cast<std::ptrdiff_t>(end - begin);
    std::iota(order.begin(), last, std::size_t{0});
    std::stable_sort(order.begin(), last, [&](std::size_t a, std::size_t b) { return count(a) > count(b); });
    const auto nobody = static_cast<std::uint32_t>(packing.size());
    std::size_t next = field.first_tier[block * kGroupsOfBlock];
    for (std::size_t g = 0; g < kGroupsOfBlock; ++g) {
      const std::size_t group = block * kGroupsOfBlock + g;
      field.first_tier[group] = next;
      field.tiers[group] = g * kLanes < end - begin ? static_cast<std::uint32_t>(count(order[g * kLanes])) : 0;
      next += field.tiers[group];
      for (std::size_t l = 0; l < kLanes; ++l) {
        const std::size_t rank = g * kLanes + l;
        const bool someone = rank < end - begin;
        field.sphere[group * kLanes + l] = someone ? static_cast<std::uint32_t>(begin + order[rank]) : nobody;
        if (someone) lane[begin + order[rank]] = static_cast<std::uint32_t>(group * kLanes + l);
        const std::size_t own = someone ? count(order[rank]) : 0;
        for (std::size_t k = 0; k < field.tiers[group]; ++k) {
          NearTier& tier = field.tier[field.first_tier[group] + k];
          const std::size_t c = k < own ? near[first[order[rank]] + k] : 0;
          tier.place[l] = kRowSize * (k < own ? list.j[c] : nobody);
          tier.shift[l] = kRowSize * (k < own ? list.image[c] : 0);
        }
      }
    }
  }

  /// From neighbour j to sphere i, and the sum of their radii [m].
  Row between(std::size_t i, std::size_t j, std::size_t image) const {
    const Row &pi = field.place[i], &pj = field.place[j], &shift = field.shift[image];
    return {pi[0] - pj[0] - shift[0], pi[1] - pj[1] - shift[1], pi[2] - pj[2] - shift[2], pi[3] + pj[3]};
  }

  /// Positions back into the fractions of the packing.
  void store() {
    const Eigen::Matrix3d inverse = packing.H.inverse();
    for (std::size_t i = 0; i < packing.size(); ++i) {
      const Eigen::Vector3d s = inverse * Eigen::Vector3d(field.place[i][0], field.place[i][1], field.place[i][2]);
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
        moved2[block] = std::max(moved2[block], distance2(field.place[i], reference[i]));
        near_moved2[block] = std::max(near_moved2[block], distance2(field.place[i], near_reference[i]));
      }
    });
    const auto farthest = [](const std::vector<double>& d2) {
      return std::sqrt(*std::max_element(d2.begin(), d2.end()));
    };
    if (!(farthest(moved2) < allowed_displacement(list, packing.H, packing.H))) {
      store();
      rebuild();
    } else if (!(farthest(near_moved2) < kOfTheSkin * near_skin)) {
      pick_near();
    }
  }

  /// Calls visit(nx, ny, nz, delta) for each contact of sphere i.
  template <class Visit>
  void visit_contacts(std::size_t i, const Visit& visit) const {
    const std::size_t group = lane[i] / kLanes, l = lane[i] % kLanes;
    for (std::size_t k = 0; k < field.tiers[group]; ++k) {
      const NearTier& tier = field.tier[field.first_tier[group] + k];
      const std::size_t j = tier.place[l] / kRowSize;
      if (j == packing.size()) break;
      const auto [dx, dy, dz, reach] = between(i, j, tier.shift[l] / kRowSize);
      const double d2 = dx * dx + dy * dy + dz * dz;
      if (!(d2 < reach * reach)) continue;
      const double d = std::sqrt(d2);
      if (!std::isfinite(dx / d + dy / d + dz / d)) {  // at zero distance, or where its square underflows
        throw Error(
            fmt::format("spheres {} and {} share one position; move one of them", packing.id[i], packing.id[j]));
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
        field.w[i] = {0, 0, 0, 1 / std::sqrt(mass)};
      }
    });
  }

  Totals forces() {
    for_each_block([&](std::size_t block, std::size_t begin, std::size_t end) {
      parts[block] = {};
      parts[block].contacts = contact_forces(field, block * kGroupsOfBlock, (block + 1) * kGroupsOfBlock);
      for (std::size_t i = begin; i < end; ++i) add_to(parts[block], i);
    });
    Totals sum;
    for (const Totals& part : parts) {
      sum.gw += part.gw;
      sum.gg += part.gg;
      sum.ww += part.ww;
      sum.contacts.overlap += part.contacts.overlap;
      sum.contacts.overlap2 += part.contacts.overlap2;
      sum.contacts.meetings += part.contacts.meetings;
      sum.f2_max = std::max(sum.f2_max, part.f2_max);
    }
    return sum;
  }

  void add_to(Totals& sum, std::size_t i) const {
    const Row &w = field.w[i], &g = field.g[i];
    const double f2 = g[3], inverse = w[3];
    if (!std::isfinite(f2))
      visit_contacts(i, [](double, double, double, double) {});  // says with whom it shares its place
    sum.f2_max = std::max(sum.f2_max, f2);
    sum.gg += f2 * inverse * inverse;
    sum.gw += g[0] * w[0] + g[1] * w[1] + g[2] * w[2];
    sum.ww += w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
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
      for (std::size_t a = 0; a < 3; ++a) m.field.place[i][a] -= back * m.field.w[i][a] * m.field.w[i][3];
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
    Row &place = m.field.place[i], &w = m.field.w[i];
    const Row& g = m.field.g[i];
    for (std::size_t a = 0; a < 3; ++a) {
      w[a] = keep * (w[a] + dt * g[a]) + along * g[a];
      place[a] += dt * w[a] * w[3];
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
    const OverlapSums& contacts = totals.contacts;
    result.E_after = 0.25 * k * contacts.overlap2;  // k delta^2/2 of each contact
    if (result.passes == 1) result.E_before = result.E_after;
    result.max_net_force = k * std::sqrt(totals.f2_max);
    result.mean_contact_force = contacts.meetings ? k * contacts.overlap / static_cast<double>(contacts.meetings) : 0;
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
