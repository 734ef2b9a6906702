#include "dem/files/state_file.hpp"

#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include "dem/element_tests/random_gas.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::dem {
namespace {

namespace fs = std::filesystem;

class StateFile : public ::testing::Test {
 protected:
  StateFile() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() /
              ("grainlaw-state-file-" + std::string(info->name()) + "-" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directory(folder_);
    file_ = folder_ / "kept.state";
  }
  ~StateFile() override { fs::remove_all(folder_); }

  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put(const std::string& content) const { std::ofstream(file_, std::ios::binary) << content; }
  std::string refusal() const {
    try {
      read_state(file_);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  }
  std::size_t files_in_folder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_, file_;
};

/// Every number of the state, in one place, so that a comparison forgets none.
std::vector<double> numbers(const State& s) {
  const Material& m = s.material;
  const Ledger& l = s.ledger;
  std::vector<double> all{m.density,
                          m.stiffness,
                          m.contact_viscosity,
                          m.background_viscosity,
                          s.time,
                          l.W_box,
                          l.D_contact,
                          l.D_background,
                          l.E_start,
                          l.E_kin_start,
                          s.sums.box_power,
                          s.sums.contact_power,
                          s.sums.drag_power,
                          s.sums.E_pot};
  all.insert(all.end(), s.packing.H.data(), s.packing.H.data() + 9);
  all.insert(all.end(), s.ref_H.data(), s.ref_H.data() + 9);
  const Packing& p = s.packing;
  for (const auto* a : {&p.radius, &p.mass, &p.sx, &p.sy, &p.sz, &p.vx, &p.vy, &p.vz, &s.ax, &s.ay, &s.az, &s.ref_x,
                        &s.ref_y, &s.ref_z}) {
    all.push_back(static_cast<double>(a->size()));
    all.insert(all.end(), a->begin(), a->end());
  }
  return all;
}

bool same_bits(const State& a, const State& b) {
  const std::vector<double> x = numbers(a), y = numbers(b);
  return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(double)) == 0 &&
         a.packing.id == b.packing.id && a.step == b.step && a.seed == b.seed && a.digest == b.digest;
}

/// A state in which every number differs from every other and none is a default.
State distinct_state(std::size_t n, bool in_motion) {
  std::uint64_t block = 0;
  const auto number = [&] { return uniform(99, Stream::position, block++)[0] - 0.5; };
  State s;
  resize(s.packing, n);
  Packing& p = s.packing;
  for (auto* a : {&p.sx, &p.sy, &p.sz, &p.vx, &p.vy, &p.vz}) {
    for (double& x : *a) x = number();
  }
  for (auto* a : {&p.radius, &p.mass}) {
    for (double& x : *a) x = 1 + number();
  }
  for (std::size_t i = 0; i < n; ++i) p.id[i] = -7 + 3 * static_cast<std::int64_t>(i);
  p.H << 1.5, number(), number(), 0, 2.5, number(), 0, 0, 3.5;
  s.material = {1 + number(), 1 + number(), 1 + number(), 1 + number()};
  s.ledger = {number(), number(), number(), number(), number()};
  s.step = 12345678901234567ull;
  s.seed = ~0ull;
  s.time = number();
  s.digest = std::string(64, 'a');
  if (in_motion) {
    for (auto* a : {&s.ax, &s.ay, &s.az, &s.ref_x, &s.ref_y, &s.ref_z}) {
      a->resize(n);
      for (double& x : *a) x = number();
    }
    s.ref_H << 1, number(), number(), 0, 2, number(), 0, 0, 3;
    s.sums = {number(), number(), number(), number()};
  }
  return s;
}

TEST_F(StateFile, ReadsBackBitForBit) {
  for (const bool in_motion : {false, true}) {
    for (const std::size_t n : {0u, 1u, 17u}) {
      State state = distinct_state(n, in_motion);
      if (n > 0) state.packing.sx[0] = -0.0;
      if (n > 0) state.packing.vy[0] = std::numeric_limits<double>::denorm_min();
      write_state(file_, state);
      EXPECT_TRUE(same_bits(read_state(file_), state)) << "n = " << n << ", in motion " << in_motion;
    }
  }
  EXPECT_EQ(files_in_folder(), 1u) << "a temporary file was left";
}

TEST_F(StateFile, SaysWhatContactsMadeIt) {
  State state = distinct_state(2, false);
  state.contacts = {0.3, 0.1, NormalForce::hertz, 0.5};
  write_state(file_, state);
  EXPECT_EQ(read_state(file_).contacts, state.contacts);
}

// Writing and reading share their order: only the bytes show that it is the documented one.
TEST_F(StateFile, NumbersStandInTheDocumentedOrder) {
  const State s = distinct_state(2, true);
  write_state(file_, s);
  const Material& m = s.material;
  const Ledger& l = s.ledger;
  std::vector<double> expected{m.density,    m.stiffness,      m.contact_viscosity, m.background_viscosity,
                               s.time,       l.W_box,          l.D_contact,         l.D_background,
                               l.E_start,    l.E_kin_start,    s.sums.box_power,    s.sums.contact_power,
                               s.sums.E_pot, s.sums.drag_power};
  for (const auto* H : {&s.packing.H, &s.ref_H}) {
    for (int i = 0; i < 9; ++i) expected.push_back((*H)(i / 3, i % 3));  // by rows
  }
  const Packing& p = s.packing;
  for (const auto* a : {&p.radius, &p.mass, &p.sx, &p.sy, &p.sz, &p.vx, &p.vy, &p.vz, &s.ax, &s.ay, &s.az, &s.ref_x,
                        &s.ref_y, &s.ref_z}) {
    expected.insert(expected.end(), a->begin(), a->end());
  }
  const std::string written = bytes();
  constexpr std::size_t kChecksum = 32;
  const std::size_t ids = p.id.size() * 8, length = expected.size() * sizeof(double);
  ASSERT_GT(written.size(), 16 + length + ids + kChecksum);
  std::vector<double> stored(expected.size());
  std::memcpy(stored.data(), written.data() + written.size() - kChecksum - ids - length, length);
  EXPECT_EQ(stored, expected);
}

TEST_F(StateFile, AFlippedBitAnywhereIsRefused) {
  write_state(file_, distinct_state(1, true));
  const std::string sound = bytes();
  for (std::size_t i = 0; i < sound.size(); ++i) {
    std::string damaged = sound;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << (i % 8)));
    put(damaged);
    EXPECT_NE(refusal().find(file_.string()), std::string::npos) << "byte " << i;
  }
}

TEST_F(StateFile, ATruncatedOrLongerFileIsRefused) {
  write_state(file_, distinct_state(2, true));
  const std::string sound = bytes();
  for (std::size_t length = 0; length < sound.size(); length += 7) {
    put(sound.substr(0, length));
    EXPECT_NE(refusal(), "") << "length " << length;
  }
  put(sound + '\0');
  EXPECT_NE(refusal(), "");
}

std::string with_checksum(std::string content) {
  std::string sum(32, '\0');
  unsigned int length = 0;
  EVP_Digest(content.data(), content.size(), reinterpret_cast<unsigned char*>(sum.data()), &length, EVP_sha256(),
             nullptr);
  return content + sum;
}

// Forged files: the checksum fits, the content does not.
TEST_F(StateFile, ForgedContentIsRefused) {
  write_state(file_, distinct_state(2, true));
  const std::string content = bytes().substr(0, bytes().size() - 32);
  const auto forged = [&](const std::function<void(std::string&)>& change) {
    std::string changed = content;
    change(changed);
    put(with_checksum(changed));
    return refusal();
  };
  EXPECT_EQ(forged([](std::string&) {}), "");
  EXPECT_NE(forged([](std::string& c) { c[8] = 99; }).find("version 99"), std::string::npos);
  EXPECT_NE(forged([](std::string& c) { c[15] = 127; }).find("header"), std::string::npos);
  EXPECT_NE(forged([](std::string& c) { c[16] = '['; }).find("header"), std::string::npos);
  const auto replace = [](const std::string& from, const std::string& to) {
    return [=](std::string& c) { c.replace(c.find(from), from.size(), to); };
  };
  EXPECT_NE(forged(replace("\"particles\":2", "\"particles\":9")).find("size"), std::string::npos);
  EXPECT_NE(forged(replace("\"particles\":2", "\"particles\":X")).find("header"), std::string::npos);
  const auto negative = [](std::string& c) {
    c.insert(c.find("\"seed\":") + 7, "-");
    ++c[12];  // length of the header
  };
  EXPECT_NE(forged(negative).find("whole number"), std::string::npos) << refusal();
  EXPECT_NE(forged(replace("\"particles\"", "\"partycles\"")).find("header"), std::string::npos);
  EXPECT_NE(forged([](std::string& c) { c.replace(c.size() - 96, 8, "\0\0\0\0\0\0\xf8\x7f", 8); }).find("finite"),
            std::string::npos);
  EXPECT_NE(forged([](std::string& c) { c.resize(c.size() - 8); }).find("size"), std::string::npos);
}

TEST_F(StateFile, ARefusedWriteLeavesTheEarlierFile) {
  const State good = distinct_state(3, false);
  write_state(file_, good);
  State bad = good;
  bad.packing.vx[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_state(file_, bad), Error);
  bad = good;
  bad.ax.assign(2, 0.0);
  EXPECT_THROW(write_state(file_, bad), Error);
  EXPECT_TRUE(same_bits(read_state(file_), good));
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(StateFile, MissingPlacesAreNamed) {
  EXPECT_NE(refusal().find("no such state file"), std::string::npos);
  const fs::path nowhere = folder_ / "none" / "kept.state";
  try {
    write_state(nowhere, distinct_state(1, false));
    FAIL() << "written into a folder that does not exist";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(nowhere.string()), std::string::npos);
  }
}

// The system accepts only a part of the file, as on a full disk.
TEST_F(StateFile, AWriteCutShortLeavesTheEarlierFile) {
  const State good = distinct_state(3, false);
  write_state(file_, good);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string message;
  try {
    write_state(file_, distinct_state(100, true));
  } catch (const Error& error) {
    message = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_NE(message.find(file_.string()), std::string::npos);
  EXPECT_TRUE(same_bits(read_state(file_), good));
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(StateFile, ALinkUnderTheNameIsReplacedNotFollowed) {
  const fs::path elsewhere = folder_ / "elsewhere";
  std::ofstream(elsewhere) << "mine";
  fs::create_symlink(elsewhere, file_);
  write_state(file_, distinct_state(1, false));
  EXPECT_FALSE(fs::is_symlink(file_));
  EXPECT_EQ(fs::file_size(elsewhere), 4u);
}

}  // namespace
}  // namespace grainlaw::dem
