#include "dem/files/state_file.hpp"

#include "model/files/fields_json.hpp"
#include "model/files/whole_number.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

constexpr SealedFormat kStateFormat{kStateMagic, kStateFileVersion, "state file"};

/// The order of the numbers in the file, told once for writing and reading: `visit` gets each scalar, `array` each
/// array of the packing's size, `optional_array` those that a resting state does not have.
template <class AnyState, class Scalar, class Array, class OptionalArray>
void for_each_number(AnyState& s, const Scalar& visit, const Array& array, const OptionalArray& optional_array) {
  for_each_field<Material>([&](const auto& field) { visit(std::invoke(field.access, s.material)); });
  auto& e = s.ledger;
  for (auto* x : {&s.time, &e.W_box, &e.D_contact, &e.D_background, &e.E_start, &e.E_kin_start}) visit(*x);
  for (auto* x : {&s.sums.box_power, &s.sums.contact_power, &s.sums.E_pot, &s.sums.drag_power}) visit(*x);
  for (auto* H : {&s.packing.H, &s.ref_H}) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) visit((*H)(row, column));
    }
  }
  auto& p = s.packing;
  for (auto* a : {&p.radius, &p.mass, &p.sx, &p.sy, &p.sz, &p.vx, &p.vy, &p.vz}) array(*a);
  for (auto* a : {&s.ax, &s.ay, &s.az, &s.ref_x, &s.ref_y, &s.ref_z}) optional_array(*a);
}

}  // namespace

nlohmann::json state_header(const State& state) {
  nlohmann::json header{{"format", "grainlaw state"},
                        {"particles", state.packing.size()},
                        {"step", state.step},
                        {"seed", state.seed},
                        {"digest", state.digest},
                        {"has_accelerations", !state.ax.empty()},
                        {"has_list_reference", !state.ref_x.empty()}};
  header.update(nlohmann::json(changed_fields(state.contacts)));
  return header;
}

void put_state(const State& state, NumberWriter& numbers) {
  const std::size_t n = state.packing.size();
  constexpr std::size_t kArrays = 16, kScalars = 64;  // more or less
  numbers.reserve(kArrays * n + kScalars);
  const auto put = [&](const double& x) { numbers.number(x); };
  const auto put_array = [&](const std::vector<double>& a) {
    if (a.size() != n) numbers.refuse();
    for (const double& x : a) numbers.number(x);
  };
  const auto put_optional = [&](const std::vector<double>& a) {
    if (!a.empty()) put_array(a);
  };
  for_each_number(state, put, put_array, put_optional);
  for (const std::int64_t id : state.packing.id) numbers.word(static_cast<std::uint64_t>(id));
  const bool whole = state.packing.id.size() == n && state.ax.size() == state.ay.size() &&
                     state.ax.size() == state.az.size() && state.ref_x.size() == state.ref_y.size() &&
                     state.ref_x.size() == state.ref_z.size();
  if (!whole) numbers.refuse();
}

State take_state(const nlohmann::json& header, NumberReader& numbers) {
  State state;
  state.step = whole_number<std::uint64_t>(header.at("step"));
  state.seed = whole_number<std::uint64_t>(header.at("seed"));
  state.digest = header.at("digest").get<std::string>();
  read_given_fields(header, state.contacts);
  const auto n = whole_number<std::uint64_t>(header.at("particles"));
  const bool accelerations = header.at("has_accelerations").get<bool>();
  const bool reference = header.at("has_list_reference").get<bool>();
  // before anything is allocated
  std::size_t scalars = 0, arrays = 1;  // the ids
  for_each_number(
      state, [&](double&) { ++scalars; }, [&](auto&) { ++arrays; }, [](auto&) {});
  arrays += (accelerations ? 3u : 0u) + (reference ? 3u : 0u);
  const std::size_t left = numbers.words_left();
  if (n > left || scalars + arrays * n > left) throw InvalidInput("its size contradicts its header");

  const auto take_array = [&](std::vector<double>& a) {
    a.resize(n);
    for (double& x : a) x = numbers.number();
  };
  const auto take_optional = [&](std::vector<double>& a) {
    const bool motion = &a == &state.ax || &a == &state.ay || &a == &state.az;
    if (motion ? accelerations : reference) take_array(a);
  };
  for_each_number(
      state, [&](double& x) { x = numbers.number(); }, take_array, take_optional);
  for (std::size_t i = 0; i < n; ++i) state.packing.id.push_back(static_cast<std::int64_t>(numbers.word()));
  check(state.packing);
  return state;
}

void write_state(const std::filesystem::path& file, const State& state, WriteFile write) {
  NumberWriter numbers;
  put_state(state, numbers);
  write_sealed(file, kStateFormat, state_header(state), numbers, write);
}

State read_state(const std::filesystem::path& file) {
  State state;
  read_sealed(file, kStateFormat,
              [&](const nlohmann::json& header, NumberReader& numbers) { state = take_state(header, numbers); });
  return state;
}

}  // namespace grainlaw::dem
