#include "model/parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "model/vocabulary/error.hpp"

namespace grainlaw {
namespace {

TEST(Parameters, TableIsConsistent) {
  std::set<std::string> names;
  for (const ParameterInfo& info : parameter_table()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_LT(info.lower, info.upper) << info.name;
    EXPECT_GE(info.start, info.lower) << info.name;
    EXPECT_LE(info.start, info.upper) << info.name;
    EXPECT_STRNE(info.symbol, "");
    EXPECT_STRNE(info.meaning, "");
    if (info.published) {
      EXPECT_GE(*info.published, info.lower) << info.name;
      EXPECT_LE(*info.published, info.upper) << info.name;
    }
  }
}

TEST(Parameters, NamesPromisedToOthers) {
  for (const char* name : {"coordination.C1",
                           "coordination.alpha",
                           "coordination.nu_c",
                           "rattlers.phi_c",
                           "rattlers.phi_v",
                           "pressure.p0",
                           "pressure.gamma_p",
                           "pressure.nu_c",
                           "overlap.D",
                           "fabric.g3",
                           "stress_ratio_max.Q_limit",
                           "stress_ratio_max.Q_c",
                           "stress_ratio_max.alpha",
                           "stress_rate.Q_limit",
                           "stress_rate.Q_c",
                           "stress_rate.alpha",
                           "fabric_max.Q_limit",
                           "fabric_max.Q_c",
                           "fabric_max.alpha",
                           "fabric_rate.Q_limit",
                           "fabric_rate.Q_c",
                           "fabric_rate.alpha",
                           "anisotropy.a1",
                           "anisotropy.a2"}) {
    EXPECT_STREQ(parameter_table()[parameter_index(name)].name, name);
  }
  EXPECT_THROW(parameter_index("pressure.P0"), InvalidInput);
  EXPECT_THROW(parameter_index(""), InvalidInput);
}

TEST(Parameters, EachNameIsTheFieldThatItSays) {
  LawParameters<double> p;
  const std::map<std::string, const double*> expected{{"coordination.C1", &p.isotropic.coordination.C1},
                                                      {"coordination.alpha", &p.isotropic.coordination.alpha},
                                                      {"coordination.nu_c", &p.isotropic.coordination.nu_c},
                                                      {"rattlers.phi_c", &p.isotropic.rattlers.phi_c},
                                                      {"rattlers.phi_v", &p.isotropic.rattlers.phi_v},
                                                      {"pressure.p0", &p.isotropic.pressure.p0},
                                                      {"pressure.gamma_p", &p.isotropic.pressure.gamma_p},
                                                      {"pressure.nu_c", &p.isotropic.pressure.nu_c},
                                                      {"steady_coordination.C1", &p.steady.coordination.C1},
                                                      {"steady_coordination.alpha", &p.steady.coordination.alpha},
                                                      {"steady_coordination.nu_c", &p.steady.coordination.nu_c},
                                                      {"steady_rattlers.phi_c", &p.steady.rattlers.phi_c},
                                                      {"steady_rattlers.phi_v", &p.steady.rattlers.phi_v},
                                                      {"steady_pressure.p0", &p.steady.pressure.p0},
                                                      {"steady_pressure.gamma_p", &p.steady.pressure.gamma_p},
                                                      {"steady_pressure.nu_c", &p.steady.pressure.nu_c},
                                                      {"overlap.D", &p.overlap_D},
                                                      {"fabric.g3", &p.fabric_g3},
                                                      {"shear.nu_c", &p.shear_nu_c},
                                                      {"stress_ratio_max.Q_limit", &p.stress_ratio_max.Q_limit},
                                                      {"stress_ratio_max.Q_c", &p.stress_ratio_max.Q_c},
                                                      {"stress_ratio_max.alpha", &p.stress_ratio_max.alpha},
                                                      {"stress_rate.Q_limit", &p.stress_rate.Q_limit},
                                                      {"stress_rate.Q_c", &p.stress_rate.Q_c},
                                                      {"stress_rate.alpha", &p.stress_rate.alpha},
                                                      {"fabric_max.Q_limit", &p.fabric_max.Q_limit},
                                                      {"fabric_max.Q_c", &p.fabric_max.Q_c},
                                                      {"fabric_max.alpha", &p.fabric_max.alpha},
                                                      {"fabric_rate.Q_limit", &p.fabric_rate.Q_limit},
                                                      {"fabric_rate.Q_c", &p.fabric_rate.Q_c},
                                                      {"fabric_rate.alpha", &p.fabric_rate.alpha},
                                                      {"lode.stress_ratio", &p.lode.stress_ratio},
                                                      {"lode.fabric", &p.lode.fabric},
                                                      {"anisotropy.a0", &p.anisotropy.a0},
                                                      {"anisotropy.a1", &p.anisotropy.a1},
                                                      {"anisotropy.a2", &p.anisotropy.a2},
                                                      {"memory.G", &p.memory.G},
                                                      {"memory.alpha", &p.memory.alpha},
                                                      {"memory.m", &p.memory.m},
                                                      {"memory.k", &p.memory.k},
                                                      {"memory.lambda", &p.memory.lambda},
                                                      {"memory.c_F", &p.memory.c_F},
                                                      {"memory.a2", &p.memory.a2},
                                                      {"memory.chi", &p.memory.chi},
                                                      {"memory.kappa", &p.memory.kappa},
                                                      {"memory.a_P", &p.memory.a_P}};
  ASSERT_EQ(expected.size(), kParameterCount);
  const auto field = fields(p);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    EXPECT_EQ(field[i], expected.at(parameter_table()[i].name)) << parameter_table()[i].name;
  }
}

TEST(Parameters, PublishedValuesAreThoseOfTables2And3) {
  const std::map<std::string, double> expected{{"coordination.C1", 8.2720},
                                               {"coordination.alpha", .5814},
                                               {"coordination.nu_c", .6646},
                                               {"rattlers.phi_c", .1216},
                                               {"rattlers.phi_v", 15.8950},
                                               {"pressure.p0", .04172},
                                               {"pressure.gamma_p", .06228},
                                               {"pressure.nu_c", .6649},
                                               {"steady_coordination.C1", 7.9219},
                                               {"steady_coordination.alpha", .5769},
                                               {"steady_coordination.nu_c", .6601},
                                               {"steady_rattlers.phi_c", .1363},
                                               {"steady_rattlers.phi_v", 15.0010},
                                               {"steady_pressure.p0", .03886},
                                               {"steady_pressure.gamma_p", .03219},
                                               {"steady_pressure.nu_c", .6581},
                                               {"overlap.D", .425},
                                               {"fabric.g3", 1.22},
                                               {"shear.nu_c", .6653},
                                               {"stress_ratio_max.Q_limit", .1137},
                                               {"stress_ratio_max.Q_c", .09166},
                                               {"stress_ratio_max.alpha", 7.916},
                                               {"stress_rate.Q_limit", 30.76},
                                               {"stress_rate.Q_c", 57.00},
                                               {"stress_rate.alpha", 16.86},
                                               {"fabric_max.Q_limit", 0},
                                               {"fabric_max.Q_c", .1694},
                                               {"fabric_max.alpha", 4.562},
                                               {"fabric_rate.Q_limit", 0},
                                               {"fabric_rate.Q_c", 57.89},
                                               {"fabric_rate.alpha", 5.366},
                                               {"anisotropy.a0", .137}};
  for (const ParameterInfo& info : parameter_table()) {
    const auto at = expected.find(info.name);
    EXPECT_EQ(info.published.has_value(), at != expected.end()) << info.name;
    if (info.published && at != expected.end()) {
      EXPECT_EQ(*info.published, at->second) << info.name;
    }
  }
}

TEST(Parameters, StartsAreNotThePublishedValues) {
  // A fit that hardly moves must not look right. Fixed or physically zero ones excepted.
  for (const ParameterInfo& info : parameter_table()) {
    if (!info.published || std::string(info.name) == "shear.nu_c" || *info.published == 0) continue;
    EXPECT_GT(std::abs(info.start - *info.published), 1e-3 * std::abs(*info.published)) << info.name;
  }
}

TEST(Parameters, CastKeepsEveryValue) {
  const LawParameters<double> p = published_parameters();
  const LawParameters<long double> q = cast<long double>(p);
  const auto from = fields(p);
  const auto to = fields(q);
  for (std::size_t i = 0; i < kParameterCount; ++i) EXPECT_EQ(static_cast<double>(*to[i]), *from[i]);
}

TEST(Parameters, CouplingNames) {
  EXPECT_EQ(to_string(Coupling::energy), "energy");
  EXPECT_EQ(to_string(Coupling::single), "single");
}

}  // namespace
}  // namespace grainlaw
