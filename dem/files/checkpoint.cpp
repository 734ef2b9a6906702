#include "dem/files/checkpoint.hpp"

#include <cmath>

#include "dem/files/sealed_file.hpp"
#include "dem/files/state_file.hpp"
#include "model/files/whole_number.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr SealedFormat kCheckpointFormat{"GRAINRUN", 1, "checkpoint"};

/// Calls visit with each value of this type in the row (a reference to it), in the order of the table of its fields.
template <class Value, class AnyRow, class Visit>
void for_each_value(AnyRow& row, const Visit& visit) {
  for_each_field<Observation>([&](const auto& field) {
    if constexpr (std::is_same_v<ValueOf<Observation, decltype(field.access)>, Value>)
      visit(std::invoke(field.access, row));
  });
}

/// Likewise its tensors, of whatever kind.
template <class AnyRow, class Visit>
void for_each_tensor(AnyRow& row, const Visit& visit) {
  for_each_field<Observation>([&](const auto& field) {
    if constexpr (requires { std::invoke(field.access, row).tensor; }) visit(std::invoke(field.access, row).tensor);
  });
}

/// Whole numbers, bits of the defined scalars, scalars (0 where undefined), tensors by rows.
void put_row(const Observation& row, NumberWriter& numbers) {
  for_each_value<int>(row, [&](int value) { numbers.word(static_cast<std::uint64_t>(value)); });
  std::uint64_t defined = 0;
  int bit = 0;
  for_each_value<double>(row, [&](double value) { defined |= std::uint64_t{!std::isnan(value)} << bit++; });
  numbers.word(defined);
  for_each_value<double>(row, [&](double value) { numbers.number(std::isnan(value) ? 0 : value); });
  for_each_tensor(row, [&](const Eigen::Matrix3d& tensor) {
    for (int i = 0; i < 9; ++i) numbers.number(tensor(i / 3, i % 3));
  });
}

Observation take_row(NumberReader& numbers) {
  Observation row;
  for_each_value<int>(row, [&](int& value) { value = static_cast<int>(numbers.word()); });
  const std::uint64_t defined = numbers.word();
  int bit = 0;
  for_each_value<double>(row, [&](double& value) {
    value = numbers.number();
    if ((defined >> bit++ & 1) == 0) value = Observation::undefined;
  });
  for_each_tensor(row, [&](Eigen::Matrix3d& tensor) {
    for (int i = 0; i < 9; ++i) tensor(i / 3, i % 3) = numbers.number();
  });
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
  write_sealed(file, kCheckpointFormat, header, numbers);
}

Checkpoint read_checkpoint(const std::filesystem::path& file) {
  Checkpoint c;
  read_sealed(file, kCheckpointFormat, [&](const nlohmann::json& header, NumberReader& numbers) {
    c.stage = header.at("stage").get<std::string>();
    c.steps_before = whole_number<std::uint64_t>(header.at("steps_before"));
    c.segment = whole_number<int>(header.at("segment"));
    c.segment_steps = whole_number<std::uint64_t>(header.at("segment_steps"));
    c.steps = whole_number<std::uint64_t>(header.at("steps"));
    c.state = take_state(header, numbers);
    for (int i = 0; i < 9; ++i) c.segment_H(i / 3, i % 3) = numbers.number();
    c.time_step = numbers.number();
    c.seconds = numbers.number();
    const auto rows = whole_number<std::uint64_t>(header.at("rows"));
    if (rows > numbers.words_left()) throw InvalidInput("its size contradicts its header");
    for (std::uint64_t i = 0; i < rows; ++i) c.rows.push_back(take_row(numbers));
  });
  return c;
}

}  // namespace grainlaw::dem
