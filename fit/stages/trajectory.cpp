#include "fit/stages/trajectory.hpp"

#include <fmt/format.h>

#include "fit/data/shear_rows.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::fit {
namespace {

/// N of every segment, orthonormalised in order; directions that lie in the span already add nothing.
std::vector<Deviator<double>> axes_of(const TestRecord& test) {
  std::vector<Deviator<double>> axes;
  for (const PathSegment& segment : test.path.segments) {
    Deviator<double> n = path_direction(segment.direction.tensor).N;
    for (const Deviator<double>& axis : axes) n -= axis * axis.dot(n);
    if (n.norm() > 1e-6) axes.push_back(n.normalized());
  }
  return axes;
}

/// Path parameter of a row from the start of its segment; check_and_sort() has seen that it lies on it.
double parameter_of(const TestRecord& test, std::size_t number, const Eigen::Matrix3d& from, const Eigen::Matrix3d& D) {
  return (test.rows[number].strain.tensor - from).cwiseProduct(D).sum() / D.squaredNorm();
}

Trajectory segment_of(const TestRecord& test, int segment, std::size_t first, std::size_t end, double nu_c,
                      const CalibrationOptions& options) {
  const Eigen::Matrix3d& D = test.path.segments[static_cast<std::size_t>(segment)].direction.tensor;
  const Observation& start = test.rows[first];
  Trajectory t;
  t.test = test.name;
  t.segment = segment;
  t.branch = test.path.branch;
  t.start = measured_state(test, start);
  t.nu_start = start.nu;
  const Eigen::Matrix3d strain_start = test.rows.front().strain.tensor - start.strain.tensor;  // compression positive
  t.dev_start = deviator<double>(strain_start);
  t.vol_start = strain_start.trace();
  t.direction = path_direction(D);
  t.axes = axes_of(test);
  t.starts_on_law = t.axes.empty();
  if (t.starts_on_law && !t.start.F.allFinite()) t.start.F.setZero();  // isotropic compression does not read it
  // towards jamming as isotropic unloading: from a measured start the law's pressure may end above the packing's nu_c
  const double nu_min = t.starts_on_law || t.direction.dx < 0 ? std::max(nu_c, options.iso_nu_min) : nu_c;

  std::vector<double> e, strain;
  std::vector<std::size_t> number;
  for (std::size_t i = first; i < end; ++i) {
    const double at = parameter_of(test, i, start.strain.tensor, D);
    if (test.rows[i].nu <= nu_min || !is_jammed(test.rows[i]) || !is_jammed(start))
      break;  // the start too is a row here
    if (!e.empty() && at < e.back()) {
      throw InvalidInput(
          fmt::format("test {}: row {} goes back on its segment; sort the rows by time", test.name, i + 1));
    }
    e.push_back(at);
    strain.push_back(at * std::max(t.direction.de, std::abs(t.direction.dx)));
    number.push_back(i);
  }
  const RowWeights rows = t.constant_volume() ? shear_window(strain, options) : whole_window(strain);
  for (std::size_t k = 0; k < rows.row.size(); ++k) {
    const std::size_t i = rows.row[k];
    t.rows.push_back({e[i], measured_state(test, test.rows[number[i]]), rows.weight[k]});
  }
  t.excluded = static_cast<int>(end - first) - 1 - static_cast<int>(t.rows.size());
  return t;
}

}  // namespace

std::vector<Trajectory> trajectories_of(const DataSet& data, double nu_c, const CalibrationOptions& options) {
  std::vector<Trajectory> all;
  for (const TestRecord* test : data.all_used()) {
    std::size_t first = 0;
    Deviator<double> s_r = Deviator<double>::Zero(), E = s_r;
    for (std::size_t i = 1; i <= test->rows.size(); ++i) {
      if (i < test->rows.size() && test->rows[i].segment == test->rows[i - 1].segment) continue;
      // The last row of a segment is the corner where the next one starts.
      if (i - first >= 2) {
        all.push_back(segment_of(*test, test->rows[i - 1].segment, first, i, nu_c, options));
        all.back().cluster = packing_of(data, *test);
        all.back().start.s_r = s_r;
        all.back().start.E = E;
        if (all.back().start.P > 0) turn_corner(Rung::memory, all.back().start, all.back().direction);
        s_r = all.back().start.s_r;
        const Eigen::Matrix3d& D = test->path.segments[static_cast<std::size_t>(all.back().segment)].direction.tensor;
        E = strain_memory(E, all.back().direction, parameter_of(*test, i - 1, test->rows[first].strain.tensor, D));
      }
      first = i - 1;
    }
  }
  return all;
}

}  // namespace grainlaw::fit
