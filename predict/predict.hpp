#pragma once
// The calibrated law along a strain path. Strain is the independent variable; the right-hand side is model's.
//   reduced:   Eqs. (17), (18) in closed form at the current nu, P by Eq. (14) (Figs. 12, 14 of the paper)
//   evolution, memory: by CVODE, stopped and re-initialised at each corner of the path, where memory may reverse; after
//              every call y must be finite and t equal to the requested output
// On request with the derivatives of every row to parameters of the law: closed form by central differences, the others
// by CVODES' forward sensitivities (segment_sensitivity.hpp).
// Dimensionless (*) throughout; strain tension positive, stress and fabric compression positive. The deviators are the
// 5-vectors of model/vocabulary/tensor.hpp.

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "model/calibrated_law.hpp"
#include "model/vocabulary/path.hpp"
#include "model/vocabulary/run_control.hpp"
#include "model/vocabulary/test_record.hpp"
#include "predict/solvers/ode.hpp"

namespace grainlaw::predict {

/// Where an output is wanted: a segment of the path and the path parameter in it, both not decreasing.
struct OutputPoint {
  int segment = 0;  ///< index of the segment
  double e = 0;     ///< path parameter in [0, length of the segment] [-]
};
GRAINLAW_FIELDS(OutputPoint, segment, e);

inline constexpr int kCurvePoints = 200;  ///< intervals of each segment of a curve that no DEM run dictates

/// `per_segment` equal intervals on each segment, ends included.
std::vector<OutputPoint> uniform_points(const std::vector<StraightSegment>& segments, int per_segment = kCurvePoints);

/// The points at which the rows of a test lie on resolve(test.path), by projection of their strain. Throws InvalidInput
/// naming a row that is off the path by more than 1e-9 of strain or 1e-6 of volume fraction, that runs back in time,
/// segment or strain, or that is no number. Rows may repeat.
std::vector<OutputPoint> points_of(const TestRecord& test);

/// Half widths of a 95 % band about what a row reports; NaN: none. By bands.hpp.
struct RowBand {
  double P = std::numeric_limits<double>::quiet_NaN();      ///< about P* [-]
  double s_dev = std::numeric_limits<double>::quiet_NaN();  ///< likewise [-]
  double s_par = std::numeric_limits<double>::quiet_NaN();
  double F_dev = std::numeric_limits<double>::quiet_NaN();
  double F_par = std::numeric_limits<double>::quiet_NaN();
};

struct PredictedRow {
  int segment = 0;                                          ///< index of the path's segment
  Strain strain;                                            ///< tension positive [-]
  double eps_vol = 0, eps_dev = 0, shear_path = 0, nu = 0;  ///< as in Observation [-]
  LawState<double> state;                                   ///< P*, sigma'*, F' [-]; all zero while unjammed
  double s_dev = 0;                                         ///< |sigma'|/P, NaN while unjammed [-]
  double s_par = 0;             ///< <sigma',N>/P, N the path's first shear direction; NaN on a path without shear [-]
  double F_dev = 0, F_par = 0;  ///< |F'| and <F',N>, likewise [-]
  RowBand mean, single;         ///< of the mean over packings, and of the run of one packing
};

/// The columns of a prediction, in the order of writing.
// clang-format off
constexpr auto fields_of(std::type_identity<PredictedRow>) {
  using R = PredictedRow;
  constexpr auto needed = Rule::needed, number = Rule::needed_number;
  return std::tuple_cat(
      place_fields<R>(number),
      std::tuple{
          Field{[](auto& r) -> auto& { return r.state.P; }, "P_star", "", "P*", "pressure times 2<r>/k", number},
          Field{&R::s_dev, "s_dev", "", "s_dev", "stress ratio, a norm", needed},
          Field{&R::s_par, "s_par", "", "s_par", "signed stress ratio along the path's first shear direction", needed},
          Field{&R::F_dev, "F_dev", "", "F_dev", "deviatoric fabric, a norm", needed},
          Field{&R::F_par, "F_par", "", "F_par", "signed deviatoric fabric along the path's first shear direction", needed},
          Field{[](auto& r) -> auto& { return r.state.sigma; }, "sigma_dev", "", "sigma'*",
                "deviatoric stress times 2<r>/k, compression positive", number},
          Field{[](auto& r) -> auto& { return r.state.F; }, "fabric_dev", "", "F'", "deviatoric fabric", needed},
          Field{[](auto& r) -> auto& { return r.mean.P; }, "P_star_mean95", "", "",
                "half width of the 95 % band of the mean curve about P*"},
          Field{[](auto& r) -> auto& { return r.single.P; }, "P_star_single95", "", "",
                "half width of the 95 % band of a single run about P*"},
          Field{[](auto& r) -> auto& { return r.mean.s_dev; }, "s_dev_mean95", "", "",
                "half width of the 95 % band of the mean curve about s_dev"},
          Field{[](auto& r) -> auto& { return r.single.s_dev; }, "s_dev_single95", "", "",
                "half width of the 95 % band of a single run about s_dev"},
          Field{[](auto& r) -> auto& { return r.mean.s_par; }, "s_par_mean95", "", "",
                "half width of the 95 % band of the mean curve about s_par"},
          Field{[](auto& r) -> auto& { return r.single.s_par; }, "s_par_single95", "", "",
                "half width of the 95 % band of a single run about s_par"},
          Field{[](auto& r) -> auto& { return r.mean.F_dev; }, "F_dev_mean95", "", "",
                "half width of the 95 % band of the mean curve about F_dev"},
          Field{[](auto& r) -> auto& { return r.single.F_dev; }, "F_dev_single95", "", "",
                "half width of the 95 % band of a single run about F_dev"},
          Field{[](auto& r) -> auto& { return r.mean.F_par; }, "F_par_mean95", "", "",
                "half width of the 95 % band of the mean curve about F_par"},
          Field{[](auto& r) -> auto& { return r.single.F_par; }, "F_par_single95", "", "",
                "half width of the 95 % band of a single run about F_par"}});
}
// clang-format on

/// What happens on the way besides corners; see path_integration.hpp.
enum class EventKind { unjammed, jammed, tension };
constexpr auto names_of(EventKind) { return std::array{"unjammed", "jammed", "tension"}; }

struct PathEvent {
  EventKind kind = EventKind::unjammed;
  OutputPoint at;  ///< segment and path parameter
  double nu = 0;   ///< volume fraction there [-]
};
constexpr auto fields_of(std::type_identity<PathEvent>) {
  return std::tuple{Field{&PathEvent::kind, "kind"}, Field{&PathEvent::at, ""}, Field{&PathEvent::nu, "nu"}};
}
static_assert(tells_every_member<PathEvent>());

/// d(row)/d(parameter) at the row's strain, per unit of the parameter. NaN from where the state unjams on: that place moves
/// with the parameters.
struct RowSlope {
  LawState<double> state;                             ///< of P*, sigma'*, F', s_r
  double s_dev = 0, s_par = 0, F_dev = 0, F_par = 0;  ///< s_par, F_par NaN on a path without shear
};

/// Whose influence on the rows is wanted; nobody's by default, which costs nothing.
struct Sensitivity {
  std::vector<std::size_t> parameters;  ///< indices in parameter_table()
  bool start_from_law = true;           ///< the start is state_from_law() and moves with them; false: it was measured
  /// Called with each row, in order, and its slopes to the parameters. Nobody keeps them: on long paths they would fill the memory.
  std::function<void(PredictedRow& row, const std::vector<RowSlope>& slopes)> use = {};
};

struct Prediction {
  Rung model = Rung::evolution;
  std::vector<PredictedRow> rows;  ///< one for each point
  SolverStatistics statistics;
  std::vector<PathEvent> events;      ///< in their order
  bool unjammed = false;              ///< P, a principal stress or nu - nu_c fell to zero: the first such event
  OutputPoint unjammed_at;            ///< where, when `unjammed`
  std::vector<std::string> warnings;  ///< e.g. "nu = 0.85 lies outside the calibrated range 0.68-0.82"
};

/// P by Eq. (14), ISO unloading branch, at `nu`; no deviators. Throws InvalidInput when nu is not above jamming.
LawState<double> state_from_law(const LawParameters<double>& parameters, double nu);

/// The state measured in a row, usually the first of a test; without fabric where the row has none, from which the reduced model
/// alone can start. Throws InvalidInput without pressure.
LawState<double> state_from_row(const Observation& row);

/// The reduced model goes without the fabric where the law or the start does not know it (NaN): then that of the rows is NaN, too.
/// The rows at `points` of the path `segments`, beginning at `start`. `coupling` and `tolerances` are not read by the
/// reduced model. Warns once for each way in which the rows leave `range`. Throws InvalidInput for a start that is not
/// jammed or points off the path; NotConverged with segment, strain and
/// the solver's word when the solver fails, when y is not finite or t differs from the requested output; Interrupted.
Prediction predict(Rung model, const LawParameters<double>& parameters, Coupling coupling,
                   const std::vector<StraightSegment>& segments, const LawState<double>& start,
                   const std::vector<OutputPoint>& points, const Tolerances& tolerances, const ValidRange& range,
                   const RunControl& control, const Sensitivity& sensitivity = {});

}  // namespace grainlaw::predict
