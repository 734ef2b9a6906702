#include "dem/engine/lanes/lane_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dem/engine/lanes/lane_search.hpp"
#include "dem/engine/lanes/large_pages.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kRounding = 1e-6;        // of the distances that the search computes in single precision
constexpr int kMaxBinsPerAxis = 1024;

using Index3 = std::array<std::uint32_t, 3>;

// Bins to the cutoff along each axis. Spheres lie in memory layer by layer of z: thin layers, and what a thread reads of
// its neighbour's spheres is little. Where a layer has more spheres than this, the cell is cut along y into stripes, one after the
// other: rows of the layers that a sphere reads stay in a core's own cache.
constexpr Index3 kReach{1, 1, 2};
constexpr double kLayer = 3000;

/// The leading 32 bits of a position, as a fraction of the edge.
std::int32_t leading(std::int32_t x) { return x; }
std::int32_t leading(std::int64_t x) { return static_cast<std::int32_t>(x >> 32); }

/// All spheres sorted by bins of the cell, in a bin by index.
struct Spatial {
  std::vector<std::int32_t> x, y, z;  // padded, as is reach
  std::vector<float> reach;
  std::vector<std::uint32_t> from;    // lane before
  std::vector<std::uint32_t> sphere;
  Index3 bins{1, 1, 1};
  std::size_t stripe = 1;             // bins along y; the last one may have fewer
  std::vector<std::size_t> start;     // of each bin, and the end
  std::array<float, 3> edge{};

  std::size_t bins_of_layer() const { return std::size_t{bins[0]} * bins[1]; }
  std::size_t at(std::size_t bx, std::size_t by, std::size_t bz) const {
    const std::size_t before = by / stripe * stripe, width = std::min(stripe, bins[1] - before);
    return (bins[2] * before + bz * width + by - before) * bins[0] + bx;
  }
  std::uint32_t bin_along(std::size_t axis, std::int32_t position) const {
    return static_cast<std::uint32_t>(std::uint64_t{static_cast<std::uint32_t>(position)} * bins[axis] >> 32);
  }
};

template <class Real>
Spatial sort_spatially(const Lanes<Real>& lanes, const std::array<double, 3>& edge, double skin, ThreadTeam& team) {
  const std::size_t n = lanes.spheres;
  const auto reach_of = [&](const PlacedGroup<Real>& group, std::size_t l) {
    return (static_cast<double>(group.radius[l]) + skin / 2) * (1 + kRounding);
  };
  Spatial s;
  double farthest = 0;
  for (std::size_t i = 0; i < n; ++i) farthest = std::max(farthest, reach_of(lanes.placed[i / kLanes], i % kLanes));
  const double cutoff = 2 * farthest * (1 + kRounding);
  const double per_axis = std::cbrt(static_cast<double>(n)) + 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const double fit = std::min({kReach[a] * edge[a] / cutoff, 4 * per_axis, double{kMaxBinsPerAxis}});
    s.bins[a] = static_cast<std::uint32_t>(std::max(1.0, fit));
    s.edge[a] = static_cast<float>(edge[a] * 0x1p-32);
  }
  const double stripes = std::max(1.0, std::round(static_cast<double>(n) / s.bins[2] / kLayer));
  s.stripe = static_cast<std::size_t>(std::ceil(s.bins[1] / stripes));
  std::vector<std::uint32_t> bin(n);
  team.for_each_block(block_count(n), [&](std::size_t block) {
    for (std::size_t i = block * kBlockSize; i < std::min(n, (block + 1) * kBlockSize); ++i) {
      const PlacedGroup<Real>& group = lanes.placed[i / kLanes];
      const std::size_t l = i % kLanes;
      bin[i] = static_cast<std::uint32_t>(s.at(s.bin_along(0, leading(group.x[l])), s.bin_along(1, leading(group.y[l])),
                                               s.bin_along(2, leading(group.z[l]))));
    }
  });
  s.start.assign(s.bins_of_layer() * s.bins[2] + 1, 0);
  for (std::size_t i = 0; i < n; ++i) ++s.start[bin[i] + 1];
  std::partial_sum(s.start.begin(), s.start.end(), s.start.begin());
  s.from.resize(n);
  std::vector<std::size_t> next(s.start.begin(), s.start.end() - 1);
  for (std::size_t i = 0; i < n; ++i) s.from[next[bin[i]]++] = static_cast<std::uint32_t>(i);

  for (auto* v : {&s.x, &s.y, &s.z}) v->assign(n + kLanes, 0);
  s.sphere.resize(n);
  s.reach.assign(n + kLanes, 0.0F);
  const auto sphere_at = [&](std::uint32_t lane) { return lanes.listed[lane / kLanes].sphere[lane % kLanes]; };
  team.for_each_block(s.bins[2], [&](std::size_t part) {
    const std::size_t first_bin = part * s.bins_of_layer(), last_bin = first_bin + s.bins_of_layer();
    for (std::size_t b = first_bin; b < last_bin; ++b) {
      const auto first = s.from.begin() + static_cast<std::ptrdiff_t>(s.start[b]), last = s.from.begin() + static_cast<std::ptrdiff_t>(s.start[b + 1]);
      std::sort(first, last, [&](std::uint32_t p, std::uint32_t q) { return sphere_at(p) < sphere_at(q); });
    }
    for (std::size_t p = s.start[first_bin]; p < s.start[last_bin]; ++p) {
      const PlacedGroup<Real>& group = lanes.placed[s.from[p] / kLanes];
      const std::size_t l = s.from[p] % kLanes;
      s.sphere[p] = lanes.listed[s.from[p] / kLanes].sphere[l];
      s.x[p] = leading(group.x[l]);
      s.y[p] = leading(group.y[l]);
      s.z[p] = leading(group.z[l]);
      s.reach[p] = static_cast<float>(reach_of(group, l));
    }
  });
  return s;
}

/// Bins up to `reach` away from b along an axis of `bins` bins, each once: [first, last] of up to two runs.
struct Runs {
  std::array<std::array<std::uint32_t, 2>, 2> run{};
  std::size_t count = 1;
};

Runs runs_around(std::uint32_t b, std::uint32_t bins, std::uint32_t reach) {
  Runs runs;
  if (bins <= 2 * reach + 1) {
    runs.run[0] = {0, bins - 1};
  } else if (b < reach) {
    runs.run = {{{0, b + reach}, {b + bins - reach, bins - 1}}};
    runs.count = 2;
  } else if (b + reach >= bins) {
    runs.run = {{{0, b + reach - bins}, {b - reach, bins - 1}}};
    runs.count = 2;
  } else {
    runs.run[0] = {b - reach, b + reach};
  }
  return runs;
}

/// Puts the places that a search found into the order of the indices of their spheres.
class Sorter {
 public:
  std::uint32_t* room_for(std::size_t count) {
    if (place_.size() < count + kLanes) {
      place_.resize(count + kLanes);
      key_.resize(count + kLanes);
    }
    return place_.data();
  }

  /// The first `count` that were written to the room.
  void write_ordered(const Spatial& s, std::size_t count, std::uint32_t* ordered) {
    constexpr std::size_t few = 128;
    if (count > few) {
      std::sort(place_.begin(), place_.begin() + static_cast<std::ptrdiff_t>(count),
                [&](std::uint32_t p, std::uint32_t q) { return s.sphere[p] < s.sphere[q]; });
      std::copy_n(place_.begin(), count, ordered);
    } else {
      for (std::size_t k = 0; k < count; ++k) key_[k] = static_cast<std::int32_t>(s.sphere[place_[k]]);
      order_by_key(key_.data(), place_.data(), count, ordered);
    }
  }

 private:
  std::vector<std::uint32_t> place_;
  std::vector<std::int32_t> key_;
};

/// Neighbours of the spheres of a block, one after the other.
struct Found {
  std::vector<std::uint32_t> neighbour;
  std::vector<std::uint32_t> count, near_count;
};

/// Spheres in the bins around that of sphere p.
struct Surroundings {
  std::array<SearchRange, 4 * (2 * kReach[1] + 1) * (2 * kReach[2] + 1)> range;
  std::size_t count = 0, spheres = 0;
};

Surroundings surroundings(const Spatial& s, std::size_t p) {
  const Runs along_x = runs_around(s.bin_along(0, s.x[p]), s.bins[0], kReach[0]), along_y = runs_around(s.bin_along(1, s.y[p]), s.bins[1], kReach[1]),
             along_z = runs_around(s.bin_along(2, s.z[p]), s.bins[2], kReach[2]);
  Surroundings around;
  for (std::size_t kz = 0; kz < along_z.count; ++kz) {
    for (std::uint32_t bz = along_z.run[kz][0]; bz <= along_z.run[kz][1]; ++bz) {
      for (std::size_t ky = 0; ky < along_y.count; ++ky) {
        for (std::uint32_t by = along_y.run[ky][0]; by <= along_y.run[ky][1]; ++by) {
          for (std::size_t kx = 0; kx < along_x.count; ++kx) {
            const std::size_t begin = s.start[s.at(along_x.run[kx][0], by, bz)], end = s.start[s.at(along_x.run[kx][1], by, bz) + 1];
            around.range[around.count++] = {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
            around.spheres += end - begin;
          }
        }
      }
    }
  }
  return around;
}

Found search(const Spatial& s, float narrower, std::size_t begin, std::size_t end) {
  Found found;
  found.count.reserve(end - begin);
  found.neighbour.resize(32 * (end - begin));
  const SearchField field{s.x.data(), s.y.data(), s.z.data(), s.reach.data(), s.edge};
  Sorter sorter;
  Surroundings around;
  std::size_t total = 0, bin = s.start.size();
  for (std::size_t p = begin; p < end; ++p) {
    const std::size_t own_bin = s.at(s.bin_along(0, s.x[p]), s.bin_along(1, s.y[p]), s.bin_along(2, s.z[p]));
    if (own_bin != bin) around = surroundings(s, p);
    bin = own_bin;
    const FoundNear count = find_near(field, p, {around.range.data(), around.count}, narrower, sorter.room_for(around.spheres));
    if (found.neighbour.size() < total + count.listed) found.neighbour.resize(2 * (total + count.listed));
    sorter.write_ordered(s, count.listed, found.neighbour.data() + total);
    found.count.push_back(static_cast<std::uint32_t>(count.listed));
    found.near_count.push_back(static_cast<std::uint32_t>(count.near));
    total += count.listed;
  }
  return found;
}

/// Sphere in lane i of the old group into lane j of the new one.
template <class Real>
void move_sphere(const SphereGroup<Real>& a, std::size_t i, SphereGroup<Real>& b, std::size_t j) {
  b.vx[j] = a.vx[i];
  b.vy[j] = a.vy[i];
  b.vz[j] = a.vz[i];
  b.inverse_mass[j] = a.inverse_mass[i];
  b.near_skin[j] = a.near_skin[i];
}

template <class Real>
void move_sphere(const PlacedGroup<Real>& a, std::size_t i, PlacedGroup<Real>& b, std::size_t j) {
  b.x[j] = a.x[i];
  b.y[j] = a.y[i];
  b.z[j] = a.z[i];
  b.ax[j] = a.ax[i];
  b.ay[j] = a.ay[i];
  b.az[j] = a.az[i];
  b.radius[j] = a.radius[i];
}

/// Where spheres go. A sphere has five indices: in the State (`sphere`), the lane where it was (`from`), its place in spatial
/// order (p, of which Spatial knows the first two), the lane where it goes (t), and that lane's group with the lane in it (g, l).
struct Seating {
  std::vector<Found> blocks;                       // of the search, by blocks of places
  std::vector<const std::uint32_t*> neighbour;     // of each place: the places of its neighbours ...
  std::vector<std::uint32_t> count;                // ... and how many
  std::vector<std::uint32_t> place;                // of each lane
  std::vector<std::uint32_t> lane;                 // of each place
  std::vector<std::uint32_t> tiers;                // of each group: neighbours of the sphere with most
};

/// Finds the neighbours of all places and seats the spheres of each block by number of near neighbours, so that the lanes of
/// a group have equally many.
Seating seat(const Spatial& s, float narrower, std::size_t n, ThreadTeam& team) {
  Seating seating;
  seating.blocks.resize(block_count(n));
  seating.neighbour.resize(n);
  for (auto* v : {&seating.count, &seating.place, &seating.lane}) v->resize(n);
  seating.tiers.assign((n + kLanes - 1) / kLanes, 0);
  team.for_each_block(seating.blocks.size(), [&](std::size_t block) {
    const std::size_t begin = block * kBlockSize, end = std::min(n, begin + kBlockSize);
    const Found& found = seating.blocks[block] = search(s, narrower, begin, end);
    const std::uint32_t* neighbour = found.neighbour.data();
    for (std::size_t p = begin; p < end; ++p) {
      seating.neighbour[p] = neighbour;
      seating.count[p] = found.count[p - begin];
      neighbour += seating.count[p];
    }
    const auto first = seating.place.begin() + static_cast<std::ptrdiff_t>(begin), last = seating.place.begin() + static_cast<std::ptrdiff_t>(end);
    std::iota(first, last, static_cast<std::uint32_t>(begin));
    std::stable_sort(first, last, [&](std::uint32_t p, std::uint32_t q) { return found.near_count[p - begin] > found.near_count[q - begin]; });
    for (std::size_t t = begin; t < end; ++t) {
      const std::uint32_t p = seating.place[t];
      seating.lane[p] = static_cast<std::uint32_t>(t);
      seating.tiers[t / kLanes] = std::max(seating.tiers[t / kLanes], seating.count[p]);
    }
  });
  return seating;
}

template <class Real>
void make_room_for_list(Lanes<Real>& lanes, const Seating& seating) {
  const std::size_t groups = seating.tiers.size();
  lanes.first_tier.assign(groups + 1, 0);
  for (std::size_t g = 0; g < groups; ++g) lanes.first_tier[g + 1] = lanes.first_tier[g] + seating.tiers[g];
  for (auto* tier : {&lanes.tier, &lanes.near_tier}) {
    reserve_on_large_pages(*tier, lanes.first_tier[groups]);
    tier->resize(lanes.first_tier[groups]);
  }
  lanes.near_first.assign(groups, 0);
  lanes.near_count.assign(groups, 0);
}

/// The list of a group: the rows of its spheres' neighbours, then nobody's.
template <class Real>
void write_tiers(Lanes<Real>& lanes, const Seating& seating, std::size_t g) {
  constexpr auto row_size = static_cast<std::uint32_t>(sizeof(SphereRow<Real>));
  const auto nobody = static_cast<std::uint32_t>(seating.tiers.size() * kLanes);
  for (std::size_t l = 0; l < kLanes; ++l) {
    const std::size_t t = g * kLanes + l;
    const std::size_t p = t < lanes.spheres ? seating.place[t] : 0;
    const std::uint32_t own = t < lanes.spheres ? seating.count[p] : 0;
    Tier* tier = lanes.tier.data() + lanes.first_tier[g];
    for (std::size_t k = 0; k < own; ++k) tier[k].row[l] = row_size * seating.lane[seating.neighbour[p][k]];
    for (std::size_t k = own; k < seating.tiers[g]; ++k) tier[k].row[l] = row_size * nobody;
  }
}

/// The groups in their new order, at first with nobody in them.
template <class Real>
struct Regrouped {
  std::vector<SphereGroup<Real>> group;
  std::vector<PlacedGroup<Real>> placed;
  std::vector<ListedGroup<Real>> listed;

  explicit Regrouped(std::size_t groups) : listed(groups) {
    reserve_on_large_pages(group, groups);
    group.resize(groups);
    PlacedGroup<Real> nobodies{};
    std::fill(std::begin(nobodies.radius), std::end(nobodies.radius), Real{kNobodysRadius});
    placed.assign(groups, nobodies);
  }
};

/// The spheres of a group from where they were.
template <class Real>
void move_in(const Lanes<Real>& lanes, const Spatial& s, const Seating& seating, std::size_t g, Regrouped<Real>& to) {
  for (std::size_t l = 0; l < kLanes && g * kLanes + l < lanes.spheres; ++l) {
    const std::size_t p = seating.place[g * kLanes + l], from = s.from[p];
    move_sphere(lanes.group[from / kLanes], from % kLanes, to.group[g], l);
    move_sphere(lanes.placed[from / kLanes], from % kLanes, to.placed[g], l);
    to.listed[g].x[l] = to.placed[g].x[l];
    to.listed[g].y[l] = to.placed[g].y[l];
    to.listed[g].z[l] = to.placed[g].z[l];
    to.listed[g].sphere[l] = s.sphere[p];
  }
}

/// Rows of the right number, nobody's at the end; they are to be written.
template <class Real>
void make_room_for_rows(Lanes<Real>& lanes) {
  for (auto* row : {&lanes.row, &lanes.next_row}) {
    reserve_on_large_pages(*row, lanes.group.size() * kLanes + 1);
    row->assign(lanes.group.size() * kLanes + 1, {});
    row->back().reach = row->back().radius = Real{kNobodysRadius};
  }
}

}  // namespace

bool fits_lanes(const std::array<double, 3>& edge, double cutoff) {
  return 2 * cutoff * (1 + 4 * kRounding) < *std::min_element(edge.begin(), edge.end());
}

template <class Real>
void arrange(Lanes<Real>& lanes, const std::array<double, 3>& edge, double skin, double near_skin, ThreadTeam& team) {
  const std::size_t n = lanes.spheres;
  if (n >= std::numeric_limits<std::int32_t>::max() - kLanes) throw InvalidInput("neighbour list: too many spheres");
  const Spatial s = sort_spatially(lanes, edge, skin, team);
  const Seating seating = seat(s, static_cast<float>(skin - near_skin), n, team);
  const std::size_t groups = seating.tiers.size();
  make_room_for_list(lanes, seating);
  Regrouped<Real> regrouped(groups);
  team.for_each_block(block_count(n), [&](std::size_t block) {
    for (std::size_t g = block * kBlockSize / kLanes; g < std::min(groups, (block + 1) * kBlockSize / kLanes); ++g) {
      write_tiers(lanes, seating, g);
      move_in(lanes, s, seating, g, regrouped);
    }
  });
  constexpr std::size_t caches = 8 << 20;
  lanes.beyond_caches = groups * (sizeof(SphereGroup<Real>) + 2 * kLanes * sizeof(SphereRow<Real>)) > caches;
  // Memory is farther away than caches; but rows that a thread asks for without need must be taken back by the thread that writes them.
  const std::size_t layers = kReach[2] * n * s.stripe / (std::size_t{s.bins[1]} * s.bins[2]), early = lanes.beyond_caches ? 4 * kBlockSize : 0;
  lanes.frontier = std::min((layers + early) / kLanes, groups);
  lanes.group = std::move(regrouped.group);
  lanes.placed = std::move(regrouped.placed);
  lanes.listed = std::move(regrouped.listed);
  make_room_for_rows(lanes);
}

template void arrange(Lanes<float>&, const std::array<double, 3>&, double, double, ThreadTeam&);
template void arrange(Lanes<double>&, const std::array<double, 3>&, double, double, ThreadTeam&);

}  // namespace grainlaw::dem
