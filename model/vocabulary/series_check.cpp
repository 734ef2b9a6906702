#include "model/vocabulary/series_check.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/vocabulary/direction_check.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

constexpr double kConsistency = 5e-4;  // relative, of two columns that say the same
constexpr double kRounding = 5e-7;     // absolute, of numbers of order one that may vanish
constexpr double kOffPath = 1e-3;      // strain by which a run may miss its path
constexpr double kIsostatic = 3e-3;    // P* from which a packing at rest has six contacts and a margin of 0.3
constexpr double kSlow = 0.01;         // inertial number beyond which dynamics rule
constexpr double kImplausible = 3;     // factor by which a mean field may be off before units are suspected
constexpr double kMeanFieldPressure = 0.87 / (2 * std::numbers::pi);  // P* over nu C <delta>/<r> at w = 3
constexpr double kLeastFabric = 0.9, kMostFabric = 2;  // F_v over nu C, nu (C + 3 phi_r): g3 = 1 ... 1.63
constexpr double kSpheres = 10000;                     // where their number is not told
constexpr double kTellingVolume = 0.01;                // change of volume over which the stiffness is judged
constexpr double kSoftest = 0.01, kStiffest = 10;      // |dP*/d eps_vol|; by Eq. (14) 0.2 ... 0.7

bool near(double a, double b) { return std::abs(a - b) <= 0.02 * std::abs(b); }

/// What the ratio of a stated to a computed number hints at.
std::string cause_of(double ratio, const char* turned) {
  if (near(ratio, -1)) return turned;
  for (const double factor : {100.0, 1e3, 1e6, 1e9}) {
    const char* unit = factor == 100 ? "per cent, or other units?" : "are the units right?";
    if (near(ratio, factor)) return fmt::format("{:g} times too large: {}", factor, unit);
    if (near(ratio, 1 / factor)) return fmt::format("{:g} times too small: {}", factor, unit);
  }
  return "columns swapped or units changed?";
}

class SeriesCheck {
 public:
  SeriesCheck(const std::vector<Observation>& rows, const Path& path, const PackingInfo& packing, const RowPlace& place)
      : rows_(rows),
        path_(path),
        packing_(packing),
        place_(place),
        segments_(resolve(path)),
        N_(shear_direction(segments_)),
        linear_(packing.contacts.normal_force == NormalForce::hooke && packing.contacts.cohesion == 0) {
    double sum = 0;
    for (const Observation& o : rows) {
      sum += o.stress.tensor.trace();
      if (o.P_star > kSurelyJammed && o.inertial_number > kSlow) slow_ = false;
      if (!o.fabric.tensor.array().isNaN().all()) with_fabric_ = true;
      if (!std::isnan(o.C_star)) with_contacts_ = true;
    }
    pulls_ = sum < 0;
  }

  void contradictions() const {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      check_strain(i);
      check_stress(i);
      check_fabric(i);
      check_contacts(i);
      check_energies(i);
    }
  }

  void physics() const {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      check_finite(i);
      check_sign(i);
    }
    contradictions();
    check_start();
    for (std::size_t i = 0; i < rows_.size(); ++i) check_segment(i);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (slow_ && linear_) check_pressure(i);
      check_place(i);
    }
    if (packing_.contacts == ContactModel{}) check_isostatic();
    if (with_fabric_) {
      for (std::size_t i = 0; i < rows_.size(); ++i) check_fabric_trace(i);
    }
    if (!with_contacts_ && linear_) check_stiffness();
    check_work();
    check_direction();
  }

 private:
  [[noreturn]] void refuse(std::size_t row, const std::string& column, const std::string& why) const {
    throw InvalidInput(fmt::format("{}: {}", place_(row, column), why));
  }

  void check_finite(std::size_t i) const {
    const Observation& o = rows_[i];
    const auto finite = [&](double value, const std::string& column) {
      if (!std::isfinite(value)) refuse(i, column, fmt::format("is {}; remove the row or repeat the test", value));
    };
    for (std::size_t c = 0; c < kComponentIndex.size(); ++c) {
      const auto [a, b] = kComponentIndex[c];
      finite(o.strain.tensor(a, b), std::string("strain_") + kComponentName[c]);
      finite(o.stress.tensor(a, b), std::string("stress_") + kComponentName[c]);
      if (with_fabric_) finite(o.fabric.tensor(a, b), std::string("fabric_") + kComponentName[c]);
    }
    finite(o.nu, "nu");
    finite(o.P_star, "P_star");
  }

  /// Overlaps only push; viscous forces may pull in what is hardly jammed. A series that pulls on the whole is turned.
  void check_sign(std::size_t i) const {
    if (packing_.contacts.cohesion > 0) return;
    const double P = rows_[i].stress.tensor.trace() / 3, unit = packing_.stress_unit();
    if (P > -kLeastPressure * unit && !(pulls_ && P < 0)) return;
    refuse(i, "stress_xx",
           fmt::format("the mean stress is {:.4g} Pa, tension; spheres only push: the stress is tension positive, "
                       "change the sign of its six columns (compression is positive)",
                       P));
  }

  /// `floor`: absolute difference that is none.
  void agree(std::size_t i, const char* column, double stated, double computed, const char* source, double floor,
             const char* turned = "its sign is turned") const {
    if (std::isnan(stated) || std::isnan(computed)) return;  // undefined
    if (std::abs(stated - computed) <= kConsistency * std::max(std::abs(stated), std::abs(computed)) + floor) return;
    refuse(i, column,
           fmt::format("is {:.8g} but {} gives {:.8g}; {}", stated, source, computed,
                       cause_of(stated / computed, turned)));
  }

  void check_strain(std::size_t i) const {
    const Observation& o = rows_[i];
    const double volume = o.strain.tensor.trace();
    agree(i, "eps_vol", o.eps_vol, volume, "the strain", kRounding,
          "their signs differ, tension is positive and compaction negative in both");
    agree(i, "eps_dev", o.eps_dev, deviatoric_norm(o.strain.tensor), "the strain", kRounding);
    if (!(o.nu > 0 && o.nu <= kMaxVolumeFraction))
      refuse(i, "nu", fmt::format("is {}, no volume fraction in (0, {}]", o.nu, kMaxVolumeFraction));
    check_volume(i, volume - rows_.front().strain.tensor.trace());
  }

  /// nu = nu_0 exp(-eps_vol), eps_vol since the first row.
  void check_volume(std::size_t i, double eps_vol) const {
    const Observation& o = rows_[i];
    const double nu_0 = rows_.front().nu, nu = nu_0 * std::exp(-eps_vol);
    if (std::isnan(nu) || std::abs(o.nu - nu) <= kConsistency * std::max(o.nu, nu)) return;
    const auto is = [&](double other) { return std::abs(o.nu - other) <= kConsistency * o.nu; };
    const Eigen::Vector3d edges = 1 + (o.strain.tensor - rows_.front().strain.tensor).diagonal().array();
    const char* why = is(nu_0 * std::exp(eps_vol))          ? "the strain is compression positive, change its sign"
                      : is(nu_0 * std::exp(-eps_vol / 100)) ? "the strain is in per cent, divide it by 100"
                      : is(nu_0 / edges.prod()) ? "the strain is over the first edges, give the logarithmic one"
                                                : "columns swapped or units changed, or nu of another volume?";
    refuse(i, "nu", fmt::format("is {:.8g} but nu_0 exp(-eps_vol) of the strain gives {:.8g}; {}", o.nu, nu, why));
  }

  void check_stress(std::size_t i) const {
    const Observation& o = rows_[i];
    const double P = o.stress.tensor.trace() / 3;
    agree(i, "P_star", o.P_star, P / packing_.stress_unit(), "the stress", 0,
          "the stress is tension positive, change the sign of its six columns");
    if (!(o.P_star > kLeastPressure) || !(P > 0)) return;
    agree(i, "s_dev", o.s_dev, deviatoric_norm(o.stress.tensor) / P, "the stress", kRounding);
    if (!N_.isZero())
      agree(i, "s_par", o.s_par, deviator<double>(o.stress.tensor).dot(N_) / P, "the stress", kRounding,
            "its sign is turned, or that of the path or the strain");
  }

  void check_fabric(std::size_t i) const {
    const Observation& o = rows_[i];
    agree(i, "F_v", o.F_v, o.fabric.tensor.trace(), "the fabric", kRounding);
    agree(i, "F_dev", o.F_dev, deviatoric_norm(o.fabric.tensor), "the fabric", kRounding);
    if (!N_.isZero()) agree(i, "F_par", o.F_par, deviator<double>(o.fabric.tensor).dot(N_), "the fabric", kRounding);
    if (!o.fabric.tensor.allFinite()) return;
    const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(o.fabric.tensor, Eigen::EigenvaluesOnly)
                             .eigenvalues()
                             .minCoeff();
    if (least < -kConsistency * o.fabric.tensor.norm() - kRounding)
      refuse(i, "fabric_xx",
             fmt::format("the fabric has the eigenvalue {:.4g}, but it is a sum of n n and cannot be "
                         "negative; is it a deviator, or are its columns swapped?",
                         least));
  }

  void check_contacts(std::size_t i) const {
    const Observation& o = rows_[i];
    if (o.rattler_fraction < 0 || o.rattler_fraction > 1)
      refuse(i, "rattler_fraction", fmt::format("is {}, no fraction in [0, 1]; in per cent?", o.rattler_fraction));
    if (o.C_star < 4 * (1 - kConsistency))
      refuse(i, "C_star",
             fmt::format("is {:.4g}, but it is the mean of spheres with four contacts and more, M4/N4; is "
                         "it C = M4/N or C_r = M/N, or are contacts counted once a pair?",
                         o.C_star));
    agree(i, "C", o.C, (1 - o.rattler_fraction) * o.C_star, "(1 - rattler_fraction) C_star", kRounding);
  }

  void check_energies(std::size_t i) const {
    const Observation& o = rows_[i];
    const double scale = std::max(std::abs(o.W_box), std::abs(o.E_pot));
    for (const auto& [value, column] : {std::pair{o.D_contact, "D_contact"}, {o.D_background, "D_background"}}) {
      if (value < -1e-3 * scale)
        refuse(i, column, fmt::format("is {:.4g} J, but what is lost is never negative; its sign is turned", value));
    }
  }

  void check_start() const {
    if (rows_.empty() || std::abs(rows_[0].nu - path_.nu) <= kConsistency * path_.nu) return;
    refuse(0, "nu",
           fmt::format("is {:.8g} but the path starts at initial.nu = {:.8g}; correct the path, or is nu of "
                       "another volume (without rattlers)?",
                       rows_[0].nu, path_.nu));
  }

  /// The pressure that so many and so deep contacts make.
  void check_pressure(std::size_t i) const {
    const Observation& o = rows_[i];
    const double nu_C = o.nu * (1 - o.rattler_fraction) * o.C_star;
    if (!std::isnan(o.mean_overlap)) {
      plausible(i, o.P_star, kMeanFieldPressure * nu_C * o.mean_overlap,
                "volume fraction, coordination and mean overlap");
    } else if (o.C_star > 7 && packing_.contacts == ContactModel{}) {
      // Eqs. (11), (14): x = ((C* - 6)/8)^(1/0.58) beyond jamming, P* = 0.0417 nu C x/0.665
      plausible(i, o.P_star, 0.0627 * nu_C * std::pow((o.C_star - 6) / 8, 1 / 0.58),
                "volume fraction and coordination");
    }
  }

  /// A packing at rest is isostatic. One row may stand out from its neighbours, three tell of a definition.
  void check_isostatic() const {
    std::size_t below = 0;
    for (std::size_t i = 0; slow_ && i < rows_.size(); ++i) {
      const Observation& o = rows_[i];
      below = o.P_star > kIsostatic && o.C_star < 6 ? below + 1 : 0;
      if (below < 3) continue;
      refuse(
          i, "C_star",
          fmt::format("is {:.4g} at P_star = {:.3g}, but a jammed packing has six contacts a sphere at least; is it C "
                      "= M4/N with rattlers, are contacts counted once a pair, or are the units of the stress right?",
                      o.C_star, o.P_star));
    }
  }

  /// What the springs of contacts demand of the pressure where nobody counted them, in steps of a hundredth of volume.
  void check_stiffness() const {
    std::size_t from = 0, steepest = 0;
    double most = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (rows_[i].P_star > 1)
        refuse(i, "P_star",
               fmt::format(
                   "is {:.4g}: overlaps would be as large as the particles; are the units of the stress right? (stress "
                   "in Pa, mean_radius in m, stiffness in kg/s^2)",
                   rows_[i].P_star));
      const double volume = std::abs(rows_[i].strain.tensor.trace() - rows_[from].strain.tensor.trace());
      if (volume < kTellingVolume) continue;
      const double slope = std::abs(rows_[i].P_star - rows_[from].P_star) / volume;
      from = i;
      if (slope < most) continue;
      most = slope;
      steepest = i;
    }
    if (from == 0 || (most > kSoftest && most < kStiffest)) return;
    if (most == 0) return;  // unjammed
    refuse(
        steepest, "P_star",
        fmt::format(
            "is {:.4g} and changes by {:.2g} per volumetric strain, where packings change by 0.2 to 0.7; are the units "
            "of the stress right? (stress in Pa, mean_radius in m, stiffness in kg/s^2)",
            rows_[steepest].P_star, most));
  }

  /// What contacts that carry demand of the fabric.
  void check_fabric_trace(std::size_t i) const {
    const Observation& o = rows_[i];
    const double nu_C = o.nu * (1 - o.rattler_fraction) * o.C_star;
    if (!(o.P_star > kSurelyJammed) || !std::isfinite(nu_C)) return;  // before, most contacts are those of rattlers
    const double F_v = o.fabric.tensor.trace(), g3 = F_v / nu_C;
    const double all = o.nu * ((1 - o.rattler_fraction) * o.C_star + 3 * o.rattler_fraction);  // nu C^r at most
    if (g3 > kLeastFabric && F_v < kMostFabric * all) return;
    refuse(i, "F_v",
           fmt::format("the trace of the fabric is {:.4g}, {:.3g} times nu (1 - rattler_fraction) C_star, where "
                       "1 to 1.7 times are possible; contacts counted once or twice too often, normalised, or "
                       "columns or units changed?",
                       F_v, g3));
  }

  /// Not judged where neither says that the packing is jammed.
  void plausible(std::size_t i, double P_star, double expected, const char* source) const {
    if (!std::isfinite(expected) || !(std::max(P_star, expected) > kSurelyJammed)) return;
    if (P_star > expected / kImplausible && P_star < expected * kImplausible) return;
    refuse(i, "P_star",
           fmt::format("is {:.4g}, but {} make one expect some {:.2g}; are units or columns mistaken? (stress in Pa, "
                       "mean_radius in m, stiffness in kg/s^2; {:.2g} times)",
                       P_star, source, expected, P_star / expected));
  }

  void check_segment(std::size_t i) const {
    const int last = static_cast<int>(segments_.size()) - 1, before = i == 0 ? 0 : rows_[i - 1].segment;
    if (rows_[i].segment < before || rows_[i].segment > last)
      refuse(i, "segment", fmt::format("is {}; it must grow from 0 to {}", rows_[i].segment, last));
  }

  /// By how much `of_strain` times the strain misses its place on the path.
  double off_path(std::size_t i, double of_strain) const {
    const StraightSegment& segment = segments_[static_cast<std::size_t>(rows_[i].segment)];
    const Eigen::Matrix3d& D = segment.direction.tensor;
    const Eigen::Matrix3d along =
        of_strain * (rows_[i].strain.tensor - rows_.front().strain.tensor) - segment.strain_start.tensor;
    return (along - std::clamp(along.cwiseProduct(D).sum() / D.squaredNorm(), 0.0, segment.length) * D).norm();
  }

  void check_place(std::size_t i) const {
    const double off = off_path(i, 1);
    if (off <= kOffPath) return;
    const auto fits = [&](double of_strain) {
      for (std::size_t k = 0; k < rows_.size(); ++k) {
        if (!(off_path(k, of_strain) <= kOffPath)) return false;
      }
      return true;
    };
    const char* why = fits(-1)     ? "the strain is compression positive, change its sign, or columns are swapped"
                      : fits(0.01) ? "the strain is in per cent, divide it by 100"
                                   : "columns swapped, or another path?";
    refuse(i, "strain", fmt::format("is {:.3g} off segment {} of the test's path; {}", off, rows_[i].segment, why));
  }

  double scatter(double of_one) const {
    return of_one / std::sqrt(packing_.particles > 0 ? static_cast<double>(packing_.particles) : kSpheres);
  }

  /// int (sigma'/P) : d eps' from the start, by the trapezoidal rule: what a packing gives back is what it holds of its
  /// shear, s^2/3 over 2G/P at most, which the distance of a reversal, 0.1, bounds by s/30.
  void check_work() const {
    double work = 0, s_0 = 0;
    for (std::size_t i = 1; i < rows_.size(); ++i) {
      const Deviator<double> before = stress_ratio(rows_[i - 1]), here = stress_ratio(rows_[i]);
      if (s_0 == 0) s_0 = before.norm();
      const Deviator<double> strain =
          deviator<double>(rows_[i - 1].strain.tensor) - deviator<double>(rows_[i].strain.tensor);
      work += (before + here).dot(strain) / 3;
      const double gives_back = 0.002 + s_0 / 30 + scatter(0.05);
      if (work > -gives_back) continue;
      refuse(
          i, "stress",
          fmt::format("its work on the shear since the start, over the pressure, is {:.3g}, but a packing gives back "
                      "{:.2g} at most: the sign of the strain or of the deviatoric stress is turned, or two of their "
                      "columns are swapped",
                      work, gives_back));
    }
  }

  void check_direction() const {
    const auto wrong = misdirection(rows_, segments_, scatter(4));
    if (wrong) refuse(wrong->row, wrong->column, wrong->why);
  }

  const std::vector<Observation>& rows_;
  const Path& path_;
  const PackingInfo& packing_;
  const RowPlace& place_;
  std::vector<StraightSegment> segments_;
  Deviator<double> N_;  // of the first shear
  bool linear_;         // contact forces are k delta
  bool slow_ = true;    // no row is jammed and ruled by dynamics
  bool pulls_ = false;  // on the whole
  bool with_fabric_ = false, with_contacts_ = false;
};

RowPlace place_in(const std::string& where) {
  return [where](std::size_t row, const std::string& column) {
    return fmt::format("{}: row {}, column '{}'", where, row + 1, column);
  };
}

}  // namespace

void check_contradictions(const std::vector<Observation>& rows, const Path& path, const PackingInfo& packing,
                          const RowPlace& place) {
  SeriesCheck(rows, path, packing, place).contradictions();
}
void check_contradictions(const std::vector<Observation>& rows, const Path& path, const PackingInfo& packing,
                          const std::string& where) {
  check_contradictions(rows, path, packing, place_in(where));
}

void check_series(const std::vector<Observation>& rows, const Path& path, const PackingInfo& packing,
                  const RowPlace& place) {
  SeriesCheck(rows, path, packing, place).physics();
}
void check_series(const std::vector<Observation>& rows, const Path& path, const PackingInfo& packing,
                  const std::string& where) {
  check_series(rows, path, packing, place_in(where));
}

}  // namespace grainlaw
