#include "dem/statics/packing_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dem/statics/contact_network.hpp"

namespace grainlaw::dem {
namespace {

/// The plane of the picture and the cell behind it [<r>].
struct View {
  int h = 0, v = 2, depth = 1;
  double plane = 0;  ///< its place along the axis of depth
  double width = 0, height = 0;
  Eigen::Matrix3d H;
};

/// Calls visit(shift) for every shift of the cell by whole edges along which something may enter the picture.
template <class Visit>
void for_images(const View& view, const Visit& visit) {
  for (int a = -1; a <= 1; ++a) {
    for (int b = -1; b <= 1; ++b) {
      for (int c = -1; c <= 1; ++c) visit(Eigen::Vector3d(view.H * Eigen::Vector3d(a, b, c)));
    }
  }
}

bool touches(const View& view, double h, double v, double reach) {
  return h + reach > 0 && h - reach < view.width && v + reach > 0 && v - reach < view.height;
}

std::vector<std::array<double, 3>> cut(const View& view, const Eigen::Matrix3Xd& x, const std::vector<double>& radius) {
  std::vector<std::array<double, 3>> circles;
  for (std::size_t i = 0; i < radius.size(); ++i) {
    for_images(view, [&](const Eigen::Vector3d& shift) {
      const Eigen::Vector3d centre = x.col(static_cast<Eigen::Index>(i)) + shift;
      const double off = centre[view.depth] - view.plane, r = radius[i];
      if (std::abs(off) >= r) return;
      const double section = std::sqrt(r * r - off * off);
      if (touches(view, centre[view.h], centre[view.v], section))
        circles.push_back({centre[view.h], centre[view.v], section});
    });
  }
  return circles;
}

void normalise(std::vector<double>& rose) {
  const double mean = std::accumulate(rose.begin(), rose.end(), 0.0) / static_cast<double>(rose.size());
  if (!(mean > 0)) return rose.clear();
  for (double& bin : rose) bin /= mean;
}

}  // namespace

PackingPicture picture_of(const State& state, int horizontal, int vertical, int threads) {
  const Packing& packing = state.packing;
  const double unit = mean_radius(packing);
  View view{horizontal, vertical, 3 - horizontal - vertical, 0, 0, 0, packing.H / unit};
  view.plane = view.H(view.depth, view.depth) / 2;
  view.width = std::min(view.H(view.h, view.h), kPictureSize);
  view.height = std::min(view.H(view.v, view.v), kPictureSize);

  Eigen::Matrix3Xd x(3, static_cast<Eigen::Index>(packing.size()));
  std::vector<double> radius;
  for (std::size_t i = 0; i < packing.size(); ++i) {
    const Eigen::Vector3d s(packing.sx[i], packing.sy[i], packing.sz[i]);
    x.col(static_cast<Eigen::Index>(i)) = view.H * (s - s.array().floor().matrix());
    radius.push_back(packing.radius[i] / unit);
  }
  PackingPicture picture;
  picture.width = view.width;
  picture.height = view.height;
  picture.circles = cut(view, x, radius);
  picture.count.assign(kRoseBins, 0);
  picture.force.assign(kRoseBins, 0);

  const auto contacts = contacts_at(packing, pairs_within(packing, 0, threads));
  const auto force_of = [&, mean = mean_radius(packing)](const NetworkContact& c) {
    if (state.contacts.normal_force == NormalForce::hooke) return c.delta;  // times k
    const double r_ij = packing.radius[c.i] * packing.radius[c.j] / (packing.radius[c.i] + packing.radius[c.j]);
    return elastic_force(state.material, state.contacts, mean, r_ij, c.delta);
  };
  double sum = 0;
  for (const NetworkContact& c : contacts) sum += force_of(c);
  const double mean = sum / static_cast<double>(contacts.size());
  for (const NetworkContact& c : contacts) {
    const double force = force_of(c) / mean;
    const double nh = c.n[view.h], nv = c.n[view.v], weight = nh * nh + nv * nv;
    const double angle = std::atan2(nv, nh) / std::numbers::pi + 1;  // of a line: 0 and 1 are one direction
    const int bin = std::min(kRoseBins - 1, static_cast<int>((angle - std::floor(angle)) * kRoseBins));
    picture.count[static_cast<std::size_t>(bin)] += weight;
    picture.force[static_cast<std::size_t>(bin)] += weight * force;
    for_images(view, [&](const Eigen::Vector3d& shift) {
      const Eigen::Vector3d from = x.col(static_cast<Eigen::Index>(c.i)) + shift, to = from - c.d / unit * c.n;
      const Eigen::Vector3d touch = from - (radius[c.i] - c.delta / (2 * unit)) * c.n;
      if (std::abs(touch[view.depth] - view.plane) > 0.5) return;
      const Eigen::Vector3d middle = (from + to) / 2;
      if (touches(view, middle[view.h], middle[view.v], c.d / (2 * unit)))
        picture.chains.push_back({from[view.h], from[view.v], to[view.h], to[view.v], force});
    });
  }
  normalise(picture.count);
  normalise(picture.force);
  return picture;
}

}  // namespace grainlaw::dem
