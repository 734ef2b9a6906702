#include "dem/state_file.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "dem/durable_file.hpp"
#include "model/error.hpp"

namespace grainlaw::dem {
namespace {

// magic[8] | version u32 | length of the header u32 | header | numbers, 8 bytes each | SHA-256[32]
constexpr std::string_view kMagic = "GRAINLAW";
constexpr std::size_t kPrefix = 16, kChecksum = 32;
constexpr std::size_t kMaxHeader = 65536;

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, kChecksum> sum{};
  unsigned int length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), sum.data(), &length, EVP_sha256(), nullptr) != 1 || length != kChecksum) {
    throw Error("SHA-256 is not available from the OpenSSL library");
  }
  return {sum.begin(), sum.end()};
}

void put_unsigned(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>((value >> (8 * i)) & 0xff));
}

std::uint64_t get_unsigned(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  }
  return value;
}

/// The order of the numbers in the file, told once for writing and reading: `visit` gets each scalar, `array` each
/// array of the packing's size, `optional_array` those that a resting state does not have.
template <class AnyState, class Scalar, class Array, class OptionalArray>
void for_each_number(AnyState& s, const Scalar& visit, const Array& array, const OptionalArray& optional_array) {
  auto& m = s.material;
  for (auto* x : {&m.density, &m.stiffness, &m.contact_viscosity, &m.background_viscosity}) visit(*x);
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

nlohmann::json header_of(const State& state) {
  return {{"format", "grainlaw state"},
          {"particles", state.packing.size()},
          {"step", state.step},
          {"seed", state.seed},
          {"digest", state.digest},
          {"has_accelerations", !state.ax.empty()},
          {"has_list_reference", !state.ref_x.empty()}};
}

std::string read_bytes(const std::filesystem::path& file) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(file, failure)) {
    throw InvalidInput(fmt::format("{}: no such state file", file.string()));
  }
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff length = in.tellg();
  std::string bytes(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  in.seekg(0);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in) throw InvalidInput(fmt::format("{}: cannot be read", file.string()));
  return bytes;
}

/// Hands out the numbers of a file one after the other; the count has been checked before.
class NumberReader {
 public:
  explicit NumberReader(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t word() {
    const std::uint64_t value = get_unsigned(bytes_.substr(0, 8));
    bytes_.remove_prefix(8);
    return value;
  }
  double number() {
    const double value = std::bit_cast<double>(word());
    finite_ = finite_ && std::isfinite(value);
    return value;
  }
  bool all_finite() const { return finite_; }

 private:
  std::string_view bytes_;
  bool finite_ = true;
};

State parse(std::string_view content) {
  const std::size_t header_length = get_unsigned(content.substr(12, 4));
  if (header_length > kMaxHeader || header_length > content.size() - kPrefix) throw InvalidInput("its header is too long");
  const auto header = nlohmann::json::parse(content.substr(kPrefix, header_length), nullptr, false);
  if (header.is_discarded() || !header.is_object()) throw InvalidInput("its header is not JSON");
  const std::string_view numbers = content.substr(kPrefix + header_length);

  State state;
  state.step = header.at("step").get<std::uint64_t>();
  state.seed = header.at("seed").get<std::uint64_t>();
  state.digest = header.at("digest").get<std::string>();
  const auto n = header.at("particles").get<std::uint64_t>();
  const bool accelerations = header.at("has_accelerations").get<bool>();
  const bool reference = header.at("has_list_reference").get<bool>();

  std::size_t scalars = 0, arrays = 1;  // the ids
  for_each_number(state, [&](double&) { ++scalars; }, [&](auto&) { ++arrays; }, [](auto&) {});
  arrays += (accelerations ? 3u : 0u) + (reference ? 3u : 0u);
  if (n > numbers.size() || numbers.size() != 8 * (scalars + arrays * n)) throw InvalidInput("its size contradicts its header");

  NumberReader reader(numbers);
  const auto read_array = [&](std::vector<double>& a) {
    a.resize(n);
    for (double& x : a) x = reader.number();
  };
  const auto read_optional = [&](std::vector<double>& a) {
    const bool motion = &a == &state.ax || &a == &state.ay || &a == &state.az;
    if (motion ? accelerations : reference) read_array(a);
  };
  for_each_number(state, [&](double& x) { x = reader.number(); }, read_array, read_optional);
  for (std::size_t i = 0; i < n; ++i) state.packing.id.push_back(static_cast<std::int64_t>(reader.word()));
  if (!reader.all_finite()) throw InvalidInput("it holds a number that is not finite");
  check(state.packing);
  return state;
}

}  // namespace

void write_state(const std::filesystem::path& file, const State& state) {
  const std::string header = header_of(state).dump();
  if (header.size() > kMaxHeader) throw Error(fmt::format("{}: the digest is too long to be written", file.string()));
  std::string out(kMagic);
  put_unsigned(out, kStateFileVersion, 4);
  put_unsigned(out, header.size(), 4);
  out += header;
  const std::size_t n = state.packing.size();
  out.reserve(out.size() + 8 * (64 + 15 * n) + kChecksum);

  bool sound = state.packing.id.size() == n;
  const auto put = [&](const double& x) {
    sound = sound && std::isfinite(x);
    put_unsigned(out, std::bit_cast<std::uint64_t>(x), 8);
  };
  const auto put_array = [&](const std::vector<double>& a) {
    sound = sound && a.size() == n;
    for (const double& x : a) put(x);
  };
  const auto put_optional = [&](const std::vector<double>& a) {
    if (!a.empty()) put_array(a);
  };
  for_each_number(state, put, put_array, put_optional);
  for (const std::int64_t id : state.packing.id) put_unsigned(out, static_cast<std::uint64_t>(id), 8);
  sound = sound && state.ax.size() == state.ay.size() && state.ax.size() == state.az.size() &&
          state.ref_x.size() == state.ref_y.size() && state.ref_x.size() == state.ref_z.size();
  if (!sound) {
    throw Error(fmt::format("{}: the state is not written because a number is not finite or an array has another length",
                            file.string()));
  }
  out += sha256(out);
  write_durably(file, out);
}

State read_state(const std::filesystem::path& file) {
  const std::string bytes = read_bytes(file);
  const auto refusal = [&](const std::string& why) {
    return InvalidInput(fmt::format("{}: {}; make it anew or give another file", file.string(), why));
  };
  if (bytes.size() < kPrefix + kChecksum || !bytes.starts_with(kMagic)) throw refusal("is not a state file, or cut short");
  const std::string_view content = std::string_view(bytes).substr(0, bytes.size() - kChecksum);
  if (sha256(content) != std::string_view(bytes).substr(content.size())) throw refusal("is damaged: its checksum does not fit");
  const std::uint64_t version = get_unsigned(content.substr(kMagic.size(), 4));
  if (version != kStateFileVersion) {
    throw refusal(fmt::format("has format version {}, this program reads {}", version, kStateFileVersion));
  }
  try {
    return parse(content);
  } catch (const InvalidInput& why) {
    throw refusal(why.what());
  } catch (const nlohmann::json::exception& why) {
    throw refusal(fmt::format("its header is not understood ({})", why.what()));
  }
}

}  // namespace grainlaw::dem
