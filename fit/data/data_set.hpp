#pragma once
// The tests of a calibration, refused when they cannot be trusted (model/vocabulary/series_check.hpp says what a series
// cannot say) and sorted by what they can say.

#include <vector>

#include "fit/data/options.hpp"
#include "model/vocabulary/test_record.hpp"

namespace grainlaw::fit {

struct DataSet {
  std::vector<const TestRecord*> isotropic;   ///< ISO unloading
  std::vector<const TestRecord*> pure_shear;  ///< one segment at constant volume
  std::vector<const TestRecord*> other;       ///< every other path with shear: UNI, sequences, reversals
  std::vector<std::string> unused;            ///< names of tests without shear that are not ISO unloading

  std::vector<const TestRecord*> all_used() const;
};

/// Points into `tests`, all of `role`. Throws InvalidInput naming test, row and column, with the remedy, for: another role, no
/// rows, a name given twice, one series under two names, one row in tests of two seeds, a packing without size or
/// stiffness, packings of two materials; rows that contradict themselves or the path; for a calibration: no ISO
/// unloading or no shear at constant volume.
DataSet check_and_sort(const std::vector<TestRecord>& tests, Role role = Role::calibration);

/// Whether any row tells the fabric; whether any tells C* and the fraction of rattlers. What needs them leaves the others out.
bool tells_fabric(const TestRecord& test);
bool counts_contacts(const TestRecord& test);
inline constexpr const char* kAddFabric = "no row tells the fabric; add the columns fabric_xx ... fabric_xy";
inline constexpr const char* kAddContacts = "no row counts contacts; add the columns C_star and rattler_fraction";

/// Independent of one another are packings (seeds), not the runs that start from one: the test's packing, from 0.
int packing_of(const DataSet& data, const TestRecord& test);

}  // namespace grainlaw::fit
