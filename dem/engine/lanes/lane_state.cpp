#include "dem/engine/lanes/lane_state.hpp"

#include <cmath>
#include <tuple>

#include "dem/engine/lanes/lane_list.hpp"

namespace grainlaw::dem {
namespace {

/// The nearest fraction of fixed point, any number of edges away.
template <class Real>
FixedPoint<Real> fixed(double fraction) {
  const double inside = fraction - std::floor(fraction);
  if constexpr (std::is_same_v<Real, float>) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(std::nearbyint(inside * 0x1p32))));
  } else {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(std::nearbyint(inside * 0x1p52)) << 12);
  }
}

/// In [0, 1), exactly.
template <class Int>
double fraction(Int x) {
  if constexpr (sizeof(Int) == 4) {
    return static_cast<double>(static_cast<std::uint32_t>(x)) * 0x1p-32;
  } else {
    return static_cast<double>(static_cast<std::uint64_t>(x) >> 12) * 0x1p-52;
  }
}

/// x, not wrapped since it was at ref, exactly.
template <class Int>
double unwrapped(Int x, Int ref) {
  using Unsigned = std::make_unsigned_t<Int>;
  const Int moved = static_cast<Int>(static_cast<Unsigned>(x) - static_cast<Unsigned>(ref));
  const double scale = sizeof(Int) == 4 ? 0x1p-32 : 0x1p-64;  // 52 significant bits: exact
  return fraction(ref) + static_cast<double>(moved) * scale;
}

double power_of_two(double x) { return std::ldexp(1.0, std::ilogb(x)); }

Units units_of(const Packing& packing, double dt) {
  double mass = 0;
  for (const double m : packing.mass) mass += m;
  return {power_of_two(mean_radius(packing)), power_of_two(dt), power_of_two(mass / static_cast<double>(packing.size()))};
}

}  // namespace

template <class Real>
Lanes<Real> make_lanes(const State& state, double dt, double skin, double near_skin, ThreadTeam& team) {
  const Packing& p = state.packing;
  Lanes<Real> lanes;
  lanes.spheres = p.size();
  lanes.unit = units_of(p, dt);
  const double length = lanes.unit.length, speed = length / lanes.unit.time, acceleration = speed / lanes.unit.time;
  lanes.group.resize((p.size() + kLanes - 1) / kLanes);
  lanes.placed.resize(lanes.group.size());
  lanes.listed.resize(lanes.group.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    SphereGroup<Real>& g = lanes.group[i / kLanes];
    PlacedGroup<Real>& placed = lanes.placed[i / kLanes];
    const std::size_t l = i % kLanes;
    placed.x[l] = fixed<Real>(state.ref_x[i]);
    placed.y[l] = fixed<Real>(state.ref_y[i]);
    placed.z[l] = fixed<Real>(state.ref_z[i]);
    g.vx[l] = static_cast<Real>(p.vx[i] / speed);
    g.vy[l] = static_cast<Real>(p.vy[i] / speed);
    g.vz[l] = static_cast<Real>(p.vz[i] / speed);
    placed.ax[l] = static_cast<Real>(state.ax[i] / acceleration);
    placed.ay[l] = static_cast<Real>(state.ay[i] / acceleration);
    placed.az[l] = static_cast<Real>(state.az[i] / acceleration);
    placed.radius[l] = static_cast<Real>(p.radius[i] / length);
    g.inverse_mass[l] = static_cast<Real>(lanes.unit.mass / p.mass[i]);
    lanes.listed[i / kLanes].sphere[l] = static_cast<std::uint32_t>(i);
  }
  const Eigen::Matrix3d& H = state.ref_H;
  arrange(lanes, {H(0, 0) / length, H(1, 1) / length, H(2, 2) / length}, skin / length, near_skin / length, team);
  for (std::size_t t = 0; t < lanes.spheres; ++t) {
    PlacedGroup<Real>& placed = lanes.placed[t / kLanes];
    const std::size_t l = t % kLanes, i = lanes.listed[t / kLanes].sphere[l];
    placed.x[l] = fixed<Real>(p.sx[i]);
    placed.y[l] = fixed<Real>(p.sy[i]);
    placed.z[l] = fixed<Real>(p.sz[i]);
  }
  return lanes;
}

template <class Real>
void store_lanes(const Lanes<Real>& lanes, State& state) {
  Packing& p = state.packing;
  const double length = lanes.unit.length, speed = length / lanes.unit.time, acceleration = speed / lanes.unit.time;
  for (std::size_t t = 0; t < lanes.spheres; ++t) {
    const SphereGroup<Real>& g = lanes.group[t / kLanes];
    const PlacedGroup<Real>& placed = lanes.placed[t / kLanes];
    const ListedGroup<Real>& listed = lanes.listed[t / kLanes];
    const std::size_t l = t % kLanes, i = listed.sphere[l];
    p.sx[i] = unwrapped(placed.x[l], listed.x[l]);
    p.sy[i] = unwrapped(placed.y[l], listed.y[l]);
    p.sz[i] = unwrapped(placed.z[l], listed.z[l]);
    state.ref_x[i] = fraction(listed.x[l]);
    state.ref_y[i] = fraction(listed.y[l]);
    state.ref_z[i] = fraction(listed.z[l]);
    p.vx[i] = static_cast<double>(g.vx[l]) * speed;
    p.vy[i] = static_cast<double>(g.vy[l]) * speed;
    p.vz[i] = static_cast<double>(g.vz[l]) * speed;
    if (lanes.predicted) continue;  // in the middle of a step, whose end gives new ones
    state.ax[i] = static_cast<double>(placed.ax[l]) * acceleration;
    state.ay[i] = static_cast<double>(placed.ay[l]) * acceleration;
    state.az[i] = static_cast<double>(placed.az[l]) * acceleration;
  }
}

template <class Real>
double sum_squared_overlaps(const Lanes<Real>& lanes, const Eigen::Matrix3d& H) {
  using Int = FixedPoint<Real>;
  using Unsigned = std::make_unsigned_t<Int>;
  const double scale = 1 / (kStepsPerEdge<Real> * lanes.unit.length);
  const double ex = H(0, 0) * scale, ey = H(1, 1) * scale, ez = H(2, 2) * scale;
  const auto between = [](Int a, Int b) {
    return static_cast<double>(static_cast<Int>(static_cast<Unsigned>(a) - static_cast<Unsigned>(b)));
  };
  double sum = 0;
  for (std::size_t g = 0; g < lanes.group.size(); ++g) {
    const PlacedGroup<Real>& own = lanes.placed[g];
    double lane[kLanes] = {};
    for (std::size_t k = lanes.first_tier[g]; k < lanes.first_tier[g + 1]; ++k) {
      for (std::size_t l = 0; l < kLanes; ++l) {
        const SphereRow<Real>& other = lanes.row[lanes.tier[k].row[l] / sizeof(SphereRow<Real>)];
        const double dx = between(own.x[l], other.x) * ex, dy = between(own.y[l], other.y) * ey, dz = between(own.z[l], other.z) * ez;
        const double reach = static_cast<double>(own.radius[l]) + static_cast<double>(other.radius);
        const double d2 = dx * dx + dy * dy + dz * dz;
        if (!(reach > 0 && d2 < reach * reach)) continue;
        const double overlap = reach - std::sqrt(d2);
        lane[l] += overlap * overlap;
      }
    }
    for (const double part : lane) sum += part;
  }
  return sum * lanes.unit.length * lanes.unit.length;
}

template <class Real>
NeighbourList plain_list(const Lanes<Real>& lanes, const Packing& p, Listed which) {
  constexpr int far = 2;  // unwrapped fractions of neighbours differ by less than 2.5
  constexpr int across = 2 * far + 1;
  NeighbourList list;
  for (int nx = -far; nx <= far; ++nx) {
    for (int ny = -far; ny <= far; ++ny) {
      for (int nz = -far; nz <= far; ++nz) list.offset.emplace_back(nx, ny, nz);
    }
  }
  const auto image = [](double difference) { return static_cast<int>(std::lround(difference)) + far; };
  std::vector<std::size_t> lane(p.size());
  for (std::size_t t = 0; t < lanes.spheres; ++t) lane[lanes.listed[t / kLanes].sphere[t % kLanes]] = t;
  list.first.push_back(0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t g = lane[i] / kLanes, l = lane[i] % kLanes;
    const auto [first, last, tier] = which == Listed::all
                                         ? std::tuple(lanes.first_tier[g], lanes.first_tier[g + 1], lanes.tier.data())
                                         : std::tuple(lanes.near_first[g], lanes.near_first[g] + lanes.near_count[g], lanes.near_tier.data());
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t t = tier[k].row[l] / sizeof(SphereRow<Real>);
      if (t >= lanes.spheres) break;
      const std::uint32_t j = lanes.listed[t / kLanes].sphere[t % kLanes];
      list.j.push_back(j);
      list.image.push_back(static_cast<std::uint32_t>(
          (image(p.sx[i] - p.sx[j]) * across + image(p.sy[i] - p.sy[j])) * across + image(p.sz[i] - p.sz[j])));
    }
    list.first.push_back(list.j.size());
  }
  return list;
}

template NeighbourList plain_list(const Lanes<float>&, const Packing&, Listed);
template NeighbourList plain_list(const Lanes<double>&, const Packing&, Listed);
template double sum_squared_overlaps(const Lanes<float>&, const Eigen::Matrix3d&);
template double sum_squared_overlaps(const Lanes<double>&, const Eigen::Matrix3d&);
template Lanes<float> make_lanes(const State&, double, double, double, ThreadTeam&);
template Lanes<double> make_lanes(const State&, double, double, double, ThreadTeam&);
template void store_lanes(const Lanes<float>&, State&);
template void store_lanes(const Lanes<double>&, State&);

}  // namespace grainlaw::dem
