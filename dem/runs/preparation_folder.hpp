#pragma once
// What a preparation yields, in its folder: kept states and series, and in progress.json what was written so far with its
// digests, so that an interrupted preparation can be taken up again.

#include <filesystem>
#include <optional>
#include <string>

#include "dem/element_tests/preparation.hpp"
#include "model/files/json_document.hpp"

namespace grainlaw::dem {

/// Name of the file of a kept state in its preparation's folder, e.g. "unloading-0.70.state".
std::string kept_file(Branch branch, double nu);
/// Likewise of the springs of its contacts, which LAMMPS reads: "unloading-0.70.restart".
std::string history_file(Branch branch, double nu);

/// The record's `packing`: seed, particles, size_width (null when unknown), mean_radius, stiffness.
OrderedJson packing_to_json(const State& state, std::optional<double> size_width);

class PreparationFolder {
 public:
  /// `key` is that of the run; kept states carry it.
  PreparationFolder(std::filesystem::path folder, std::string key, const ContactModel& contacts);

  /// Reads progress.json; false when it or a file that it names is missing or damaged.
  bool take_up();

  /// Its callbacks throw Error when a file cannot be written.
  PreparationSink sink();

  OrderedJson packing(const PackingOptions& options) const;  ///< null without kept states
  OrderedJson states() const { return OrderedJson(progress_.at("states")); }
  OrderedJson warnings() const { return OrderedJson(progress_.at("warnings")); }

 private:
  void keep(const KeptState& kept);
  void series(Branch branch, const std::vector<Observation>& rows);
  void warn(const std::string& warning);
  void note_file(const std::string& name);
  void save() const;

  std::filesystem::path folder_;
  std::string key_;
  ContactModel contacts_;  // of the kept states
  OrderedJson progress_ = OrderedJson::object();
};

}  // namespace grainlaw::dem
