#include "dem/engine/neighbour_list.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

using Index3 = std::array<int, 3>;

constexpr int kMaxBinsPerAxis = 1024;

/// Position inside the cell and radius [m].
struct Place {
  double x, y, z, r;
};

/// Spheres sorted into bins of the cell: bin b holds order[start[b] .. start[b+1]).
struct Bins {
  Index3 count{1, 1, 1};
  Index3 reach{1, 1, 1};  // bins to search to either side
  std::vector<std::uint32_t> order;
  std::vector<std::size_t> start;
  std::vector<Index3> wrapped;  // image in which the list finds a sphere: floor of its fraction
  std::vector<std::size_t> bin;
  std::vector<Place> place;     // wrapped positions in the order of `order`

  std::size_t at(const Index3& b) const {
    return (static_cast<std::size_t>(b[0]) * static_cast<std::size_t>(count[1]) + static_cast<std::size_t>(b[1])) *
               static_cast<std::size_t>(count[2]) + static_cast<std::size_t>(b[2]);
  }
};

/// Distances between opposite faces of the cell.
Eigen::Vector3d face_distances(const Eigen::Matrix3d& H) { return H.inverse().rowwise().norm().cwiseInverse(); }

Place place_of(const Packing& p, std::size_t i, const Index3& wrapped) {
  const Eigen::Vector3d x = p.H * Eigen::Vector3d(p.sx[i] - wrapped[0], p.sy[i] - wrapped[1], p.sz[i] - wrapped[2]);
  return {x[0], x[1], x[2], p.radius[i]};
}

Bins sort_into_bins(const Packing& p, double cutoff) {
  Bins bins;
  const std::size_t n = p.size();
  const Eigen::Vector3d heights = face_distances(p.H);
  const double per_axis = std::cbrt(static_cast<double>(n)) + 1;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    // no more bins than spheres: a flat cell or tiny spheres must not cost memory
    const double fit = std::min({heights(a) / cutoff, 4 * per_axis, double{kMaxBinsPerAxis}});
    bins.count[axis] = std::max(1, static_cast<int>(fit));
    const double reach = std::ceil(cutoff * bins.count[axis] / heights(a));
    if (!(reach < 1e6)) throw InvalidInput("neighbour list: the cell is far smaller than its spheres");
    bins.reach[axis] = static_cast<int>(reach);
  }
  const std::size_t total = bins.at({bins.count[0] - 1, bins.count[1] - 1, bins.count[2] - 1}) + 1;
  bins.start.assign(total + 1, 0);
  bins.order.resize(n);
  bins.wrapped.resize(n);
  bins.bin.resize(n);
  const std::array<const std::vector<double>*, 3> s{&p.sx, &p.sy, &p.sz};
  for (std::size_t i = 0; i < n; ++i) {
    Index3 b{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double fraction = (*s[a])[i], image = std::floor(fraction);
      bins.wrapped[i][a] = static_cast<int>(image);
      b[a] = std::min(static_cast<int>((fraction - image) * bins.count[a]), bins.count[a] - 1);
    }
    bins.bin[i] = bins.at(b);
    ++bins.start[bins.bin[i] + 1];
  }
  for (std::size_t b = 0; b < total; ++b) bins.start[b + 1] += bins.start[b];
  std::vector<std::size_t> next(bins.start.begin(), bins.start.end() - 1);
  bins.place.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t slot = next[bins.bin[i]]++;
    bins.order[slot] = static_cast<std::uint32_t>(i);
    bins.place[slot] = place_of(p, i, bins.wrapped[i]);
  }
  return bins;
}

int floor_div(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

struct Entry {
  std::uint32_t j;
  Index3 n;
  bool operator<(const Entry& other) const { return std::tie(j, n) < std::tie(other.j, other.n); }
};

/// All entries of sphere i.
void find_entries(const Packing& p, const Bins& bins, double skin, std::size_t i, std::vector<Entry>& found) {
  const Place place = place_of(p, i, bins.wrapped[i]);
  Index3 home{};
  std::size_t rest = bins.bin[i];
  for (int a = 2; a >= 0; --a) {
    const auto axis = static_cast<std::size_t>(a);
    const auto count = static_cast<std::size_t>(bins.count[axis]);
    home[axis] = static_cast<int>(rest % count);
    rest /= count;
  }
  Index3 b{}, step{};
  for (step[0] = -bins.reach[0]; step[0] <= bins.reach[0]; ++step[0]) {
    for (step[1] = -bins.reach[1]; step[1] <= bins.reach[1]; ++step[1]) {
      for (step[2] = -bins.reach[2]; step[2] <= bins.reach[2]; ++step[2]) {
        Index3 image{};  // cell that the searched bin lies in, relative to the cell of sphere i
        for (std::size_t a = 0; a < 3; ++a) {
          image[a] = floor_div(home[a] + step[a], bins.count[a]);
          b[a] = home[a] + step[a] - image[a] * bins.count[a];
        }
        const std::size_t bin = bins.at(b);
        const Eigen::Vector3d shift = p.H * Eigen::Vector3d(image[0], image[1], image[2]);
        const Place own{place.x - shift[0], place.y - shift[1], place.z - shift[2], place.r + skin};
        for (std::size_t k = bins.start[bin]; k < bins.start[bin + 1]; ++k) {
          const Place& other = bins.place[k];
          const double dx = own.x - other.x, dy = own.y - other.y, dz = own.z - other.z, reach = own.r + other.r;
          if (!(dx * dx + dy * dy + dz * dz < reach * reach)) continue;
          const std::uint32_t j = bins.order[k];
          Index3 n{};
          for (std::size_t a = 0; a < 3; ++a) n[a] = bins.wrapped[i][a] + image[a] - bins.wrapped[j][a];
          if (j != i || n != Index3{}) found.push_back({j, n});
        }
      }
    }
  }
  std::sort(found.begin(), found.end());
}

}  // namespace

void wrap(Packing& p) {
  for (auto* s : {&p.sx, &p.sy, &p.sz}) {
    for (double& fraction : *s) {
      fraction -= std::floor(fraction);
      if (fraction >= 1) fraction = 0;  // rounding of a fraction just below 0
    }
  }
}

NeighbourList build_list(const Packing& p, double skin, ThreadTeam& team) {
  const std::size_t n = p.size();
  if (n >= std::numeric_limits<std::uint32_t>::max()) throw InvalidInput("neighbour list: too many spheres");
  NeighbourList list;
  list.skin = skin;
  list.first.assign(n + 1, 0);
  if (n == 0) return list;
  list.r_max = *std::max_element(p.radius.begin(), p.radius.end());
  const Bins bins = sort_into_bins(p, 2 * list.r_max + skin);

  struct BlockEntries {
    std::vector<Entry> entries;
    std::vector<std::size_t> count;
  };
  std::vector<BlockEntries> blocks(block_count(n));
  team.for_each_block(blocks.size(), [&](std::size_t block) {
    std::vector<Entry> found;
    BlockEntries& own = blocks[block];
    for (std::size_t i = block * kBlockSize; i < std::min(n, (block + 1) * kBlockSize); ++i) {
      found.clear();
      find_entries(p, bins, skin, i, found);
      own.entries.insert(own.entries.end(), found.begin(), found.end());
      own.count.push_back(found.size());
    }
  });

  std::size_t total = 0;
  for (const BlockEntries& block : blocks) total += block.entries.size();
  list.j.reserve(total);
  list.image.reserve(total);
  std::vector<Index3> images;
  std::size_t i = 0;
  for (const BlockEntries& block : blocks) {
    for (const Entry& entry : block.entries) {
      // few distinct images occur, most often the one used last
      auto known = std::find(images.begin(), images.end(), entry.n);
      if (known == images.end()) known = images.insert(images.end(), entry.n);
      list.j.push_back(entry.j);
      list.image.push_back(static_cast<std::uint32_t>(known - images.begin()));
    }
    for (const std::size_t count : block.count) {
      list.first[i + 1] = list.first[i] + count;
      ++i;
    }
  }
  for (const Index3& image : images) list.offset.emplace_back(image[0], image[1], image[2]);
  return list;
}

double allowed_displacement(const NeighbourList& list, const Eigen::Matrix3d& ref_H, const Eigen::Matrix3d& H) {
  // H = ref_H most of the time while relaxing, and nearly so elsewhere: the cheap bound first
  const Eigen::Matrix3d stretch = H * ref_H.inverse();
  double sigma_min = 1 - (stretch - Eigen::Matrix3d::Identity()).norm();
  const double reach = 2 * list.r_max;
  double allowed = (sigma_min * (reach + list.skin) - reach) / 2;
  if (allowed < 0.25 * list.skin) {
    const Eigen::Matrix3d square = stretch.transpose() * stretch;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(square, Eigen::EigenvaluesOnly);
    // at most 1: a cell that grows adds less to the gap of small spheres than to that of the largest
    sigma_min = std::min(1.0, std::sqrt(std::max(0.0, eigen.eigenvalues()(0))));
    allowed = (sigma_min * (reach + list.skin) - reach) / 2;
  }
  return allowed;
}

}  // namespace grainlaw::dem
