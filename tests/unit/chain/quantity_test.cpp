#include "chain/import/quantity.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace grainlaw::chain {
namespace {

TEST(Quantity, IsGuessedFromCommonNames) {
  for (const auto& [name, quantity] : {std::pair{"sigma_xx", "stress_xx"},
                                       {"sxx", "stress_xx"},
                                       {"S12", "stress_xy"},
                                       {"σxx", "stress_xx"},
                                       {"stress_yz", "stress_yz"},
                                       {"s_zy", "stress_yz"},
                                       {"p", "p"},
                                       {"q", "q"},
                                       {"e_a", "eps_a"},
                                       {"eps_v", "eps_v"},
                                       {"void ratio", "void_ratio"},
                                       {"e", "void_ratio"},
                                       {"nu", "nu"},
                                       {"Fxx", "fabric_xx"},
                                       {"e_xx", "strain_xx"},
                                       {"Lx", "Lx"},
                                       {"C*", "C_star"}}) {
    const Quantity* is = guessed(name);
    ASSERT_NE(is, nullptr) << name;
    EXPECT_EQ(is->name, quantity) << name;
  }
  for (const char* name : {"E", "P", "Q", "step", "x", "Z", "ec"}) EXPECT_EQ(guessed(name), nullptr) << name;
  for (const auto& [title, name, unit] :
       {std::tuple{"sxx[kPa]", "sxx", "kPa"}, {"sxx (kPa)", "sxx", "kPa"}, {"sxx_kPa", "sxx", "kPa"}}) {
    EXPECT_EQ(parted(title).name, name);
    EXPECT_EQ(parted(title).unit, unit);
  }
  EXPECT_EQ(parted("eps_s").unit, std::nullopt);
}

/// By their definitions (SI Brochure, 9th edition: tables 4, 7 and 8): each in terms of another.
TEST(Quantity, UnitsKeepTheirRatios) {
  const auto ratio = [](UnitKind kind, const std::string& unit, const std::string& other) {
    return factor_of(kind, unit).value() / factor_of(kind, other).value();
  };
  using enum UnitKind;
  for (const auto& [kind, unit, other, expected] : {std::tuple{stress, "kPa", "Pa", 1e3},
                                                    {stress, "MPa", "kPa", 1e3},
                                                    {stress, "GPa", "MPa", 1e3},
                                                    {stress, "bar", "kPa", 1e2},
                                                    {stress, "bar", "hPa", 1e3},
                                                    {stress, "N/m^2", "Pa", 1},
                                                    {stress, "N/mm^2", "MPa", 1},
                                                    {strain, "-", "%", 1e2},
                                                    {strain, "%", "mm/m", 1e1},
                                                    {strain, "m/m", "-", 1},
                                                    {number, "-", "%", 1e2},
                                                    {length, "m", "cm", 1e2},
                                                    {length, "cm", "mm", 1e1},
                                                    {length, "mm", "um", 1e3},
                                                    {length, "um", "µm", 1},
                                                    {time, "s", "ms", 1e3},
                                                    {time, "ms", "us", 1e3},
                                                    {time, "min", "s", 60},
                                                    {time, "h", "min", 60}}) {
    EXPECT_DOUBLE_EQ(ratio(kind, unit, other), expected) << unit << " / " << other;
  }
  for (const auto& [kind, unit] : {std::pair{stress, "Pa"}, {strain, "-"}, {number, "-"}, {length, "m"}, {time, "s"}})
    EXPECT_EQ(factor_of(kind, unit), 1) << unit;
  EXPECT_EQ(factor_of(stress, "%"), std::nullopt);
}

}  // namespace
}  // namespace grainlaw::chain
