#pragma once
// The tests of a calibration, refused when they cannot be trusted and sorted by what they can say. Most columns of a row
// follow from others; where they do not, columns were swapped or units changed on the way.
//   P* = 2<r>/k tr(sigma)/3,  nu = nu_0 exp(-eps_vol),  eps_vol = tr eps,  F_v = tr F,  C = (1 - phi_r) C*,
//   eps_dev, s_dev, F_dev: norms of the tensors;  s_par, F_par: their parts along the test's first shear
//   strain: on the segment of the path that the row says
// Two relations hold for any packing of soft spheres, within factors that depend on the size distribution:
//   P* = g_p nu C <delta>/(2 pi <r>), g_p = 0.7 ... 1;  F_v = g3 nu C, g3 = 1 ... 1.5

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
/// stiffness; rows that contradict themselves or the path; for a calibration: no ISO unloading or no shear
/// at constant volume.
DataSet check_and_sort(const std::vector<TestRecord>& tests, Role role = Role::calibration);

/// Independent of one another are packings (seeds), not the runs that start from one: the test's packing, from 0.
int packing_of(const DataSet& data, const TestRecord& test);

}  // namespace grainlaw::fit
