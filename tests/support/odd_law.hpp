#pragma once
// A calibrated law with odd values in every field: files are tested without a fit.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "model/calibrated_law.hpp"
#include "model/files/fields_json.hpp"
#include "model/files/path_json.hpp"

namespace grainlaw::testing {

inline CalibratedLaw odd_law() {
  CalibratedLaw law;
  law.coupling = Coupling::single;
  law.converged = true;
  law.parameters = published_parameters();
  law.covariance = Eigen::MatrixXd::Zero(kParameterCount, kParameterCount);
  const auto values = fields(law.parameters);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    *values[i] = std::nextafter(*values[i] * (1 - 1e-3 / 7), 0.0);
    law.estimates[i] = {*values[i], 0.1 / static_cast<double>(i + 3), Status::fitted, i % 2 ? "a note" : "",
                        1 + 1.0 / static_cast<double>(i + 3)};
    for (std::size_t j = 0; j < kParameterCount; ++j) {
      law.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          (i == j ? 1 : 0.1) / static_cast<double>(i + j + 3);
    }
  }
  const auto drop = [&](const char* name, Status status) {
    const std::size_t i = parameter_index(name);
    law.estimates[i].status = status;
    law.estimates[i].standard_error = std::nan("");
    law.estimates[i].degrees_of_freedom = std::nan("");
    law.covariance.row(static_cast<Eigen::Index>(i)).setZero();
    law.covariance.col(static_cast<Eigen::Index>(i)).setZero();
  };
  drop("anisotropy.a2", Status::not_identified);
  drop("shear.nu_c", Status::fixed);
  law.scatter = {3, 22, 1.0 / 700, 1.0 / 60, std::nan("")};
  law.range.nu_min = 0.1 + 0.2;
  law.range.nu_max = 0.82;
  law.range.eps_dev_max = 1.0 / 3;
  law.range.eps_vol_max = 0.2;
  law.range.shear_path_max = 2.0 / 3;
  law.rehearsals = {{"there-and-back",
                     PathKind::cyclic,
                     {0.1 + 0.6, 0.82, 1.0 / 7, 1.0 / 3, -1, 1.0 / 9, 4, 3, true},
                     5,
                     {{Rung::memory, {211, 1.0 / 3, 0.1, 2.0 / 7}, {0, 0, 0, 0}, {211, 0.4, 1.0 / 11, 3}},
                      {Rung::reduced, {}, {}, {}}},
                     {0.7, Branch::loading, {{Mode::D2, direction_of(Mode::D2), ExtentKind::eps_dev, 1.0 / 30}}}}};
  law.dataset_digest = std::string(64, 'b');
  return law;
}

/// Equal bit for bit, but for values that must not be read.
inline void expect_same(const CalibratedLaw& a, const CalibratedLaw& b) {
  const auto x = fields(a.parameters), y = fields(b.parameters);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    EXPECT_EQ(a.estimates[i].status, b.estimates[i].status);
    EXPECT_EQ(a.estimates[i].note, b.estimates[i].note);
    if (a.estimates[i].status == Status::not_identified) continue;
    EXPECT_EQ(std::memcmp(x[i], y[i], sizeof(double)), 0) << parameter_table()[i].name;
    if (!std::isnan(a.estimates[i].standard_error)) {
      EXPECT_EQ(a.estimates[i].standard_error, b.estimates[i].standard_error);
      EXPECT_EQ(a.estimates[i].degrees_of_freedom, b.estimates[i].degrees_of_freedom);
    }
  }
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.scatter.packings, b.scatter.packings);
  EXPECT_EQ(a.scatter.degrees_of_freedom, b.scatter.degrees_of_freedom);
  EXPECT_EQ(a.scatter.compression, b.scatter.compression);
  EXPECT_EQ(a.scatter.s_par, b.scatter.s_par);
  EXPECT_EQ(std::isnan(a.scatter.F_par), std::isnan(b.scatter.F_par));
  EXPECT_EQ(a.coupling, b.coupling);
  EXPECT_EQ(a.range.nu_min, b.range.nu_min);
  EXPECT_EQ(a.range.nu_max, b.range.nu_max);
  EXPECT_EQ(a.range.eps_dev_max, b.range.eps_dev_max);
  EXPECT_EQ(a.range.eps_vol_max, b.range.eps_vol_max);
  EXPECT_EQ(a.range.shear_path_max, b.range.shear_path_max);
  ASSERT_EQ(a.rehearsals.size(), b.rehearsals.size());
  for (std::size_t i = 0; i < a.rehearsals.size(); ++i) {
    EXPECT_EQ(fields_to_json(a.rehearsals[i]), fields_to_json(b.rehearsals[i]));
    EXPECT_EQ(path_to_json(a.rehearsals[i].path), path_to_json(b.rehearsals[i].path));
  }
}

}  // namespace grainlaw::testing
