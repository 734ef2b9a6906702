#include "dem/files/state_file.hpp"

#include "dem/files/sealed_file.hpp"
#include "dem/files/state_record.hpp"

namespace grainlaw::dem {
namespace {

constexpr SealedFormat kFormat{"GRAINLAW", kStateFileVersion, "state file"};

}  // namespace

void write_state(const std::filesystem::path& file, const State& state) {
  NumberWriter numbers;
  put_state(state, numbers);
  write_sealed(file, kFormat, state_header(state), numbers);
}

State read_state(const std::filesystem::path& file) {
  State state;
  read_sealed(file, kFormat,
              [&](const nlohmann::json& header, NumberReader& numbers) { state = take_state(header, numbers); });
  return state;
}

}  // namespace grainlaw::dem
