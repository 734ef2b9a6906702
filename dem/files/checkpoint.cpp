#include "dem/files/checkpoint.hpp"

#include <array>
#include <cmath>

#include "dem/files/sealed_file.hpp"
#include "dem/files/state_record.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr SealedFormat kFormat{"GRAINRUN", 1, "checkpoint"};

// A new member of Observation must be added below (its checkpoint would lose it); the size changes with it.
static_assert(sizeof(Observation) == 4 * sizeof(Eigen::Matrix3d) + 30 * sizeof(double));

/// Scalars of a row, which may be undefined.
template <class AnyRow>
auto scalars(AnyRow& o) {
  return std::array{&o.time,           &o.eps_vol,      &o.eps_dev,     &o.shear_path,       &o.nu,
                    &o.P_star,         &o.s_dev,        &o.s_par,       &o.F_v,              &o.F_dev,
                    &o.F_par,          &o.shape_strain, &o.shape_stress, &o.shape_fabric,    &o.lode_strain,
                    &o.lode_stress,    &o.lode_fabric,  &o.C_r,         &o.C,                &o.C_star,
                    &o.rattler_fraction, &o.mean_overlap, &o.E_kin,     &o.E_pot,            &o.W_box,
                    &o.D_contact,      &o.D_background, &o.energy_residual, &o.inertial_number};
}

template <class AnyRow>
auto tensors(AnyRow& o) {
  return std::array{&o.strain.tensor, &o.stress.tensor, &o.stress_kinetic.tensor, &o.fabric.tensor};
}

/// segment, bits of the defined scalars, scalars (0 where undefined), tensors by rows.
void put_row(const Observation& row, NumberWriter& numbers) {
  std::uint64_t defined = 0;
  const auto values = scalars(row);
  for (std::size_t i = 0; i < values.size(); ++i) defined |= std::uint64_t{!std::isnan(*values[i])} << i;
  numbers.word(static_cast<std::uint64_t>(row.segment));
  numbers.word(defined);
  for (const double* value : values) numbers.number(std::isnan(*value) ? 0 : *value);
  for (const auto* tensor : tensors(row)) {
    for (int i = 0; i < 9; ++i) numbers.number((*tensor)(i / 3, i % 3));
  }
}

Observation take_row(NumberReader& numbers) {
  Observation row;
  row.segment = static_cast<int>(numbers.word());
  const std::uint64_t defined = numbers.word();
  const auto values = scalars(row);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = numbers.number();
    *values[i] = (defined >> i & 1) != 0 ? value : Observation::undefined;
  }
  for (auto* tensor : tensors(row)) {
    for (int i = 0; i < 9; ++i) (*tensor)(i / 3, i % 3) = numbers.number();
  }
  return row;
}

}  // namespace

void write_checkpoint(const std::filesystem::path& file, const Checkpoint& c) {
  nlohmann::json header = state_header(c.state);
  header["format"] = "grainlaw checkpoint";
  header["stage"] = c.stage;
  header["steps_before"] = c.steps_before;
  header["segment"] = c.segment;
  header["segment_steps"] = c.segment_steps;
  header["steps"] = c.steps;
  header["rows"] = c.rows.size();
  NumberWriter numbers;
  put_state(c.state, numbers);
  for (int i = 0; i < 9; ++i) numbers.number(c.segment_H(i / 3, i % 3));
  numbers.number(c.time_step);
  numbers.number(c.seconds);
  for (const Observation& row : c.rows) put_row(row, numbers);
  write_sealed(file, kFormat, header, numbers);
}

Checkpoint read_checkpoint(const std::filesystem::path& file) {
  Checkpoint c;
  read_sealed(file, kFormat, [&](const nlohmann::json& header, NumberReader& numbers) {
    c.stage = header.at("stage").get<std::string>();
    c.steps_before = header.at("steps_before").get<std::uint64_t>();
    c.segment = header.at("segment").get<int>();
    c.segment_steps = header.at("segment_steps").get<std::uint64_t>();
    c.steps = header.at("steps").get<std::uint64_t>();
    c.state = take_state(header, numbers);
    for (int i = 0; i < 9; ++i) c.segment_H(i / 3, i % 3) = numbers.number();
    c.time_step = numbers.number();
    c.seconds = numbers.number();
    const auto rows = header.at("rows").get<std::uint64_t>();
    if (rows > numbers.words_left()) throw InvalidInput("its size contradicts its header");
    for (std::uint64_t i = 0; i < rows; ++i) c.rows.push_back(take_row(numbers));
  });
  return c;
}

}  // namespace grainlaw::dem
