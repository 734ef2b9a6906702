#include "chain/import/series.hpp"

#include <fmt/format.h>

#include <cmath>

#include "chain/import/sources.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

constexpr double kTellingVolume = 1e-3;  // change of ln nu from which its sign says that of the strain

class SeriesImport {
 public:
  SeriesImport(const Mapping& mapping, const TestMapping& test) : how_(*test.series), sources_(mapping, test) {}

  ForeignRows read() {
    rows_.resize(sources_.rows());
    for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i] = as_given(i);
    settle_stress_sign();
    if (strain_has_sign()) settle_strain_sign();
    set_strains();
    sources_.describe(stress_sign_, strain_sign_, foreign_);
    foreign_.place = [sources = sources_](std::size_t row, const std::string& column) {
      return sources.place_of_ours(row, column);
    };
    foreign_.rows = std::move(rows_);
    return std::move(foreign_);
  }

 private:
  double value(std::size_t row, const char* quantity) const { return sources_.value(row, quantity, true); }

  Eigen::Matrix3d triaxial(double axial, double radial) const {
    Eigen::Matrix3d a = radial * Eigen::Matrix3d::Identity();
    a(how_.axis, how_.axis) = axial;
    return a;
  }

  /// All but the strain.
  Observation as_given(std::size_t row) const {
    Observation o;
    o.time = value(row, "time");
    o.nu = sources_.volume_fraction(row);
    if (sources_.has_tensor("stress")) {
      o.stress.tensor = sources_.tensor(row, "stress");
    } else {
      const double p = sources_.value(row, sources_.stress_column()),
                   q = sources_.has("q") ? sources_.value(row, "q") : 0;
      o.stress.tensor = triaxial(p + 2 * q / 3, p - q / 3);
    }
    o.fabric.tensor = sources_.has_tensor("fabric") ? sources_.tensor(row, "fabric")
                                                    : Eigen::Matrix3d::Constant(Observation::undefined);
    o.rattler_fraction = value(row, "rattler_fraction");
    o.C_star = sources_.has("C") ? value(row, "C") / (1 - o.rattler_fraction) : value(row, "C_star");
    o.C_r = value(row, "C_r");
    o.mean_overlap = value(row, "mean_overlap");
    o.inertial_number = value(row, "inertial_number");
    return o;
  }

  void note(const std::string& text) { foreign_.notes.push_back(text); }

  void settle_stress_sign() {
    double sum = 0, most = 0;
    std::size_t row = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double P = rows_[i].stress.tensor.trace() / 3;
      sum += P;
      if (std::abs(P) > std::abs(most)) {
        most = P;
        row = i;
      }
    }
    const Positive seen = sum < 0 ? Positive::tension : Positive::compression;
    stress_sign_ = how_.stress_sign.value_or(seen);
    if (stress_sign_ != seen && sum != 0)
      throw InvalidInput(
          fmt::format("{}: the mean stress is {:.4g} Pa with {} declared positive, but grains only push: stress sign? "
                      "declare \"sign\": "
                      "{{\"stress\": \"{}\"}}, or is it another column?",
                      sources_.place(row, sources_.stress_column()), most, to_string(stress_sign_), to_string(seen)));
    if (!how_.stress_sign) note(fmt::format("stress: {} is positive, since grains only push", to_string(seen)));
    if (stress_sign_ == Positive::compression) return;
    for (Observation& o : rows_) o.stress.tensor *= -1;
  }

  bool strain_has_sign() const { return sources_.has_tensor("strain") || sources_.has("eps_v"); }

  /// The volume strain of the table.
  double volume_strain(std::size_t row) const {
    return sources_.has("eps_v") ? sources_.value(row, "eps_v") : sources_.tensor(row, "strain").trace();
  }

  /// The row whose volume fraction differs most from the first says what compaction looks like.
  void settle_strain_sign() {
    double most = 0;
    std::size_t row = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double x = std::log(rows_[i].nu / rows_[0].nu);
      if (!(std::abs(x) > std::abs(most))) continue;
      most = x;
      row = i;
    }
    const double volume = volume_strain(row) - volume_strain(0);
    const bool evident = std::abs(most) >= kTellingVolume && volume != 0;
    if (!evident && !how_.strain_sign)
      throw InvalidInput(fmt::format(
          "{}: the sign of the strain is neither declared nor evident, since {}; give \"sign\": "
          "{{\"strain\": \"compression\"}} or \"tension\" in {}",
          sources_.table(), sources_.tells_volume() ? "the volume hardly changes" : "nothing else tells the volume",
          sources_.mapping()));
    const Positive seen = (volume > 0) == (most > 0) ? Positive::compression : Positive::tension;
    strain_sign_ = how_.strain_sign.value_or(seen);
    if (evident && strain_sign_ != seen)
      throw InvalidInput(
          fmt::format("{}: the volume fraction goes from {:.6g} to {:.6g} while the volumetric strain changes by "
                      "{:+.4g} with {} declared "
                      "positive: strain sign? declare \"sign\": {{\"strain\": \"{}\"}}, or is it another column?",
                      sources_.place(row, sources_.strain_column()), rows_[0].nu, rows_[row].nu, volume,
                      to_string(strain_sign_), to_string(seen)));
    if (!how_.strain_sign) note(fmt::format("strain: {} is positive, by the volume fraction", to_string(seen)));
  }

  /// Of a strain of the table, in its sign.
  double logarithmic(std::size_t row, double given) const {
    const double e = strain_sign_ == Positive::tension ? given : -given;
    if (!how_.nominal) return e;
    if (!(e > -1))
      throw InvalidInput(
          fmt::format("{}: the nominal strain {:.4g} leaves no length; is it in per cent, or logarithmic?",
                      sources_.place(row, sources_.strain_column()), given));
    return std::log1p(e);
  }

  Eigen::Matrix3d strain_of_tensor(std::size_t row) const {
    const Eigen::Matrix3d given = sources_.tensor(row, "strain");
    Eigen::Matrix3d strain;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (i != j && how_.nominal && given(i, j) != 0)
          throw InvalidInput(
              fmt::format("{}: nominal strain with shear says too little of the rotation; give logarithmic strain",
                          sources_.place(row, "strain_xy")));
        strain(i, j) =
            i == j ? logarithmic(row, given(i, j)) : logarithmic(row, given(i, j)) / (how_.engineering_shear ? 2 : 1);
      }
    }
    return strain;
  }

  Eigen::Matrix3d strain(std::size_t row) const {
    if (sources_.has_tensor("strain")) return strain_of_tensor(row);
    if (sources_.has_edges()) {
      Eigen::Vector3d log;
      for (int i = 0; i < 3; ++i) {
        const std::string edge{'L', static_cast<char>('x' + i)};
        const double length = sources_.value(row, edge);
        if (!(length > 0))
          throw InvalidInput(
              fmt::format("{}: {} is no length; is it another column?", sources_.place(row, edge), length));
        log(i) = std::log(length);
      }
      return log.asDiagonal();
    }
    if (sources_.has("eps_a")) {
      const double a = logarithmic(row, sources_.value(row, "eps_a")),
                   v = logarithmic(row, sources_.value(row, "eps_v"));
      return triaxial(a, (v - a) / 2);
    }
    const double v = sources_.has("eps_v") ? logarithmic(row, sources_.value(row, "eps_v")) : -std::log(rows_[row].nu);
    return v / 3 * Eigen::Matrix3d::Identity();
  }

  void set_strains() {
    const Eigen::Matrix3d first = strain(0);
    if (first.norm() > 0 && strain_has_sign()) note("strain counts from the first row");
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      set_strain(rows_[i], {strain(i) - first});
      if (!sources_.tells_volume()) rows_[i].nu = *how_.nu_start * std::exp(-rows_[i].eps_vol);
    }
  }

  SeriesMapping how_;
  Sources sources_;
  std::vector<Observation> rows_;
  ForeignRows foreign_;
  Positive stress_sign_ = Positive::compression, strain_sign_ = Positive::tension;
};

}  // namespace

ForeignRows read_series(const Mapping& mapping, const TestMapping& test) {
  require_packing(mapping, test);
  if (test.series->file.empty())
    throw InvalidInput(fmt::format("{}: test {}: series: misses the key 'file'; give a table, relative to {}",
                                   mapping.name, test.name, mapping.name));
  return SeriesImport(mapping, test).read();
}

}  // namespace grainlaw::chain
