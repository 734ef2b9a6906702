#include "dem/runs/path_probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem/element_tests/stepper.hpp"
#include "dem/runs/run_store.hpp"
#include "dem/statics/elastic_moduli.hpp"
#include "model/files/column.hpp"
#include "model/files/digest.hpp"
#include "model/files/output.hpp"
#include "model/files/whole_number.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kRoundingOfPaths = 1e-9;

/// max(|d eps_vol|, |d eps_dev|) per unit of e.
double length_rate(const StraightSegment& segment) {
  return std::max(std::abs(segment.eps_vol_rate()), segment.eps_dev_rate());
}

std::string digest_of(const OrderedJson& progress) {
  return sha256(progress.at("places").dump() + progress.at("rows").dump() + progress.at("warnings").dump());
}

}  // namespace

PathProbes::PathProbes(std::filesystem::path folder, ProbeRequest request, const std::vector<StraightSegment>& segments,
                       int threads, const RunControl& control)
    : folder_(std::move(folder)), request_(std::move(request)), segments_(segments), threads_(threads) {
  control_.stop = control.stop;  // the run itself reports
}

bool PathProbes::take_up() {
  if (!std::filesystem::exists(folder_ / kProgress)) return true;  // nothing was probed yet
  try {
    const OrderedJson progress(read_json(folder_ / kProgress, JsonSource::own));
    if (progress.at("sha256") != digest_of(progress)) return false;
    done_ = whole_number<std::size_t>(Json(progress.at("places")));
    lines_ = progress.at("rows").get<std::vector<std::string>>();
    warnings_ = progress.at("warnings").get<std::vector<std::string>>();
    return true;
  } catch (const InvalidInput&) {
    return false;
  } catch (const Json::exception&) {
    return false;
  }
}

double PathProbes::length_before(std::size_t segment) const {
  double length = 0;
  for (std::size_t i = 0; i < segment; ++i) length += length_rate(segments_[i]) * segments_[i].length;
  return length;
}

StepObserver PathProbes::observer() {
  return [this](Stepper& stepper, int segment, double e) {
    const auto index = static_cast<std::size_t>(segment);
    const double length = length_before(index) + length_rate(segments_[index]) * e;
    if (length < request_.every * static_cast<double>(done_) - kRoundingOfPaths) return;
    probe(stepper.simulation().state(), segment, e);
    save();
  };
}

void PathProbes::probe(const State& state, int segment, double e) {
  const Deviator<double> own = shear_direction(segments_);
  const bool sheared = own.squaredNorm() > 0;
  const Deviator<double> N = sheared ? own : -deviator<double>(direction_of(Mode::D2).tensor).normalized();
  ProbeOptions options;
  options.steps = request_.steps;
  options.threads = threads_;
  const ElasticProbe probe = probe_moduli(state, N, options, control_);
  double sheared_before = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(segment); ++i) sheared_before += shear_length(segments_[i]);
  for (ProbeRow& row : rows_of(probe, stress_unit(state))) {
    row.time = state.time;
    fill_path(row, segments_.empty() ? StraightSegment{} : segments_[static_cast<std::size_t>(segment)], segment, e,
              sheared_before);
    if (!sheared) row.s_par = row.F_par = Observation::undefined;
    lines_.push_back(csv_line(row));
  }
  const std::string place = fmt::format(
      "probe {}, at eps_dev = {:.4g}, nu = {:.4f}", done_,
      segments_.empty() ? 0 : deviatoric_norm(segments_[static_cast<std::size_t>(segment)].strain(e).tensor),
      probe.state.nu);
  if (!probe.relaxed)
    warnings_.push_back(
        fmt::format("{}: not at rest, max net force {:.2g} of the mean contact force", place, probe.residual));
  if (probe.spheres > 0 && !probe.stable)
    warnings_.push_back(fmt::format("{}: no positive stiffness, no moduli", place));
  ++done_;
}

void PathProbes::finish(const State& end) {
  if (segments_.empty() && done_ == 0) probe(end, 0, 0);
  std::string text = csv_header<ProbeRow>() + "\n";
  for (const std::string& line : lines_) text += line + "\n";
  write_durably(folder_ / "probes.csv", text);
}

void PathProbes::save() const {
  OrderedJson progress{{"places", done_}, {"rows", lines_}, {"warnings", warnings_}};
  progress["sha256"] = digest_of(progress);
  write_json(folder_ / kProgress, progress);
}

}  // namespace grainlaw::dem
