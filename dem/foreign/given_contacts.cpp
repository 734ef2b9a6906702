#include "dem/foreign/given_contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "dem/engine/contacts.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kGap = 0.05;       // of the smallest radius: spheres this far apart may be listed, rounded as they are
constexpr double kMissing = 1e-3;   // of the radii: a deeper overlap must have a contact
constexpr double kOpposite = 1e-3;  // of the force: by how much the two entries of a contact may differ
constexpr double kLeastNormal = 0.5;  // of the forces, along the contacts: below, columns are swapped or frames mixed

/// One entry of the neighbour list; each pair has two, of opposite branch vectors.
struct Touching {
  std::size_t i = 0, j = 0, mirror = 0;
  Eigen::Vector3d branch;                           // x_i - x_j - H n
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // on i
  int listed = 0;                                   // by i
  std::size_t line = 0;
};

class GivenContacts {
 public:
  explicit GivenContacts(const Packing& packing) : p_(packing) {
    ThreadTeam team(1);
    const double skin = kGap * *std::min_element(p_.radius.begin(), p_.radius.end());
    list_ = build_list(p_, skin, team);
    const std::vector<Eigen::Vector3d> shift = image_shifts(p_.H, list_);
    for (std::size_t i = 0; i < p_.size(); ++i) {
      const Row x = place_with_radius(p_, i);
      for (std::size_t e = list_.first[i]; e < list_.first[i + 1]; ++e) {
        const Row y = place_with_radius(p_, list_.j[e]);
        const Eigen::Vector3d& h = shift[list_.image[e]];
        entries_.push_back({i, list_.j[e], 0, {x[0] - y[0] - h[0], x[1] - y[1] - h[1], x[2] - y[2] - h[2]}});
      }
    }
    for (Touching& entry : entries_) entry.mirror = opposite(entry);
  }

  void take(const ListedContact& listed) {
    if (listed.force.isZero(0)) return;
    Touching& entry = entries_[find(listed)];
    if (entry.listed++ > 0)
      throw InvalidInput(fmt::format("contact {} is listed twice in the same sense (lines {} and {}); remove one",
                                     names(entry.i, entry.j), entry.line, listed.line));
    entry.force = listed.force;
    entry.line = listed.line;
  }

  GivenSums sum(bool may_pull) {
    GivenSums given;
    given.listed_twice = both_ways();
    complete();
    double force = 0, net = 0, along = 0;
    for (std::size_t i = 0; i < p_.size(); ++i) {
      Eigen::Vector3d on_sphere = Eigen::Vector3d::Zero();
      add_sphere(given.sums, p_.radius[i], [&](const auto& add) {
        for (std::size_t e = list_.first[i]; e < list_.first[i + 1]; ++e) {
          const Touching& c = entries_[e];
          if (c.listed == 0) continue;
          const double distance = c.branch.norm();
          const Eigen::Vector3d n = c.branch / distance;
          add({n * n.transpose(), 0.5 * c.force * c.branch.transpose(), reach(c) - distance, 0});
          on_sphere += c.force;
          force += c.force.norm();
          along += c.force.dot(n);
        }
      });
      net += on_sphere.norm();
    }
    if (!may_pull) judge(force, along);
    Eigen::Matrix3d& virial = given.sums.virial;
    const Eigen::Matrix3d symmetric = 0.5 * (virial + virial.transpose());
    if (force > 0) {
      given.antisymmetry = (virial - symmetric).norm() / symmetric.norm();
      given.unbalanced = net / static_cast<double>(p_.size()) / (force / static_cast<double>(given.sums.contacts));
    }
    virial = symmetric;
    return given;
  }

 private:
  double reach(const Touching& c) const { return p_.radius[c.i] + p_.radius[c.j]; }
  std::string names(std::size_t i, std::size_t j) const { return fmt::format("{}-{}", p_.id[i], p_.id[j]); }

  /// The entries of sphere i with sphere j: one for each image that is near.
  std::pair<std::size_t, std::size_t> between(std::size_t i, std::size_t j) const {
    const auto begin = list_.j.begin() + static_cast<std::ptrdiff_t>(list_.first[i]),
               end = list_.j.begin() + static_cast<std::ptrdiff_t>(list_.first[i + 1]);
    const auto [from, to] = std::equal_range(begin, end, static_cast<std::uint32_t>(j));
    return {from - list_.j.begin(), to - list_.j.begin()};
  }

  std::size_t nearest(std::size_t i, std::size_t j, const Eigen::Vector3d& branch) const {
    const auto [from, to] = between(i, j);
    std::size_t best = from;
    for (std::size_t e = from; e < to; ++e) {
      if ((entries_[e].branch - branch).squaredNorm() < (entries_[best].branch - branch).squaredNorm()) best = e;
    }
    return best;
  }

  std::size_t opposite(const Touching& c) const { return nearest(c.j, c.i, -c.branch); }

  std::size_t find(const ListedContact& listed) const {
    const std::size_t i = listed.first, j = listed.second;
    const auto [from, to] = between(i, j);
    if (from == to)
      throw InvalidInput(
          fmt::format("contact {} (line {}) has a force, but the spheres do not touch; are the contacts of "
                      "this frame, positions and radii in one unit, and ids right?",
                      names(i, j), listed.line));
    if (!listed.branch.allFinite() && to - from > 1)
      throw InvalidInput(
          fmt::format("contact {} (line {}): two images of the spheres touch, the cell is small; give the "
                      "branch vectors, too",
                      names(i, j), listed.line));
    if (!listed.branch.allFinite()) return from;
    const std::size_t found = nearest(i, j, listed.branch);
    if ((entries_[found].branch - listed.branch).norm() > kGap * reach(entries_[found]))
      throw InvalidInput(
          fmt::format("contact {} (line {}): its branch vector is not x_first - x_second of the frame; is "
                      "its sign turned?",
                      names(i, j), listed.line));
    return found;
  }

  /// Whether each contact is listed by both of its spheres; their forces become opposite.
  bool both_ways() {
    std::optional<bool> twice;
    for (Touching& c : entries_) {
      if (c.listed == 0) continue;
      Touching& other = entries_[c.mirror];
      if (twice && *twice != (other.listed > 0))
        throw InvalidInput(
            fmt::format("contact {} (line {}) is listed {}, others {}; list each contact once, or each "
                        "by both of its spheres",
                        names(c.i, c.j), c.line, *twice ? "once" : "twice", *twice ? "twice" : "once"));
      twice = other.listed > 0;
      if (!*twice) continue;
      if ((c.force + other.force).norm() > kOpposite * c.force.norm())
        throw InvalidInput(
            fmt::format("contact {} is listed by both of its spheres (lines {} and {}), but the forces "
                        "are not opposite",
                        names(c.i, c.j), c.line, other.line));
      c.force = 0.5 * (c.force - other.force);
      other.force = -c.force;
    }
    return twice.value_or(false);
  }

  /// Each contact as both of its spheres see it; no overlap without one.
  void complete() {
    for (Touching& c : entries_) {
      Touching& other = entries_[c.mirror];
      if (c.listed > 0 && other.listed == 0) {
        other.force = -c.force;
        other.listed = 1;
      }
    }
    for (const Touching& c : entries_) {
      const double overlap = reach(c) - c.branch.norm();
      if (c.listed == 0 && overlap > kMissing * reach(c))
        throw InvalidInput(
            fmt::format("spheres {} overlap by {:.2g} of their radii but no contact with a force is listed; is "
                        "the list whole (all groups, no cutoff), and of this frame?",
                        names(c.i, c.j), overlap / reach(c)));
    }
  }

  static void judge(double force, double along) {
    if (force == 0) return;
    if (along < 0)
      throw InvalidInput(
          "the forces pull on the whole; say on which sphere they act: \"force_on\": \"second\", or \"first\"");
    if (along < kLeastNormal * force)
      throw InvalidInput(
          fmt::format("the forces do not follow the contacts: {:.2g} of them act along the line of centres; "
                      "are columns swapped, or contacts of another frame?",
                      along / force));
  }

  const Packing& p_;
  NeighbourList list_;
  std::vector<Touching> entries_;
};

}  // namespace

GivenSums sum_given(const Packing& packing, const std::vector<ListedContact>& contacts, bool may_pull) {
  GivenContacts given(packing);
  for (const ListedContact& contact : contacts) given.take(contact);
  return given.sum(may_pull);
}

}  // namespace grainlaw::dem
