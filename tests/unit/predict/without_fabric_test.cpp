#include <cmath>

#include "model/calibrated_law.hpp"
#include "predict/predict.hpp"
#include "tests/support/synthetic_dataset.hpp"
#include "tests/support/temporary_folder.hpp"

namespace grainlaw::predict {
namespace {

TEST(PredictionWithoutFabric, SaysNothingOfIt) {
  CalibratedLaw law;
  law.parameters = testing::synthetic_truth();
  law.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const bool of_fabric = std::string_view(parameter_table()[i].name).starts_with("fabric_");
    law.estimates[i].status = of_fabric ? Status::not_identified : Status::fitted;
    if (!of_fabric) law.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = 1e-8;
  }
  forget_unknown_fabric(law);
  EXPECT_EQ(missing_parameter(law, Rung::reduced), std::nullopt);
  EXPECT_EQ(missing_parameter(law, Rung::evolution), parameter_index("fabric_max.Q_limit"));
  const auto segments =
      resolve(Path{0.72, Branch::unloading, {testing::synthetic_segment(Mode::UNI, ExtentKind::target_nu, 0.78)}});
  std::size_t rows_with_slopes = 0;
  const auto check_slopes = [&](const predict::PredictedRow&, const std::vector<predict::RowSlope>& slopes) {
    for (const predict::RowSlope& slope : slopes)
      EXPECT_TRUE(std::isfinite(slope.state.P) && std::isfinite(slope.s_par));
    ++rows_with_slopes;
  };
  const predict::Prediction prediction = predict::predict(
      Rung::reduced, law.parameters, law.coupling, segments, predict::state_from_law(law.parameters, 0.72),
      predict::uniform_points(segments, 10), {}, ValidRange{}, {}, {uncertain_parameters(law), true, check_slopes});
  ASSERT_EQ(prediction.rows.size(), 11u);
  for (const predict::PredictedRow& row : prediction.rows) {
    EXPECT_NEAR(row.state.P, law.parameters.isotropic.P_star(row.nu), 1e-12);
    EXPECT_TRUE(std::isfinite(row.s_par) && std::isnan(row.F_par) && std::isnan(row.F_dev) &&
                row.state.F.array().isNaN().all());
  }
  EXPECT_EQ(rows_with_slopes, prediction.rows.size());
  LawState<double> start = predict::state_from_law(law.parameters, 0.72);
  start.F.setConstant(Observation::undefined);
  EXPECT_NE(testing::refusal([&] {
              predict::predict(Rung::evolution, testing::synthetic_truth(), law.coupling, segments, start,
                               predict::uniform_points(segments, 10), {}, ValidRange{}, {});
            }).find("the start tells no fabric"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw::predict
