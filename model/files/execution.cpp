#include "model/files/execution.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/crypto.h>
#include <sys/resource.h>
#include <Eigen/Core>

#include <ctime>

#include "grainlaw_build_info.hpp"

namespace grainlaw {

Stopwatch::Stopwatch()
    : start_(std::chrono::steady_clock::now()),
      began_(fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))) {}

double Stopwatch::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double peak_memory_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

std::string version_text() { return fmt::format("grainlaw {} ({})", build_info::version, build_info::git_revision); }

OrderedJson provenance(const std::string& command, int threads, const Stopwatch& stopwatch) {
  OrderedJson object = OrderedJson::object();
  object["grainlaw"] = std::string(build_info::version);
  object["git_revision"] = std::string(build_info::git_revision);
  object["engine_version"] = kEngineVersion;
  object["compiler"] = std::string(build_info::compiler);
  object["build_type"] = std::string(build_info::build_type);
  object["compile_flags"] = std::string(build_info::compile_flags);
  object["libraries"] = {
      {"Ceres", GRAINLAW_CERES_VERSION},
      {"SUNDIALS", GRAINLAW_SUNDIALS_VERSION},
      {"Eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
      {"nlohmann_json",
       fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
      {"OpenSSL", std::string(OpenSSL_version(OPENSSL_VERSION_STRING))}};
  object["command"] = command;
  object["threads"] = threads;
  object["began"] = stopwatch.began();
  object["seconds"] = stopwatch.seconds();
  object["peak_memory_MB"] = peak_memory_megabytes();
  return object;
}

OrderedJson provenance(const Execution& execution) {
  return provenance(execution.command, execution.threads, execution.stopwatch);
}

}  // namespace grainlaw
