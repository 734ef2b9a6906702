#pragma once
// The series of a test as CSV, doubles bit for bit.

#include <filesystem>
#include <string>
#include <vector>

#include "model/vocabulary/test_record.hpp"

namespace grainlaw {

std::string series_text(const std::vector<Observation>& rows);
void write_series(const std::filesystem::path& file, const std::vector<Observation>& rows);

/// Sets in all rows of a test what follows from strain, stress and fabric: eps_vol, eps_dev, shear_path, P_star, s_dev, s_par, F_v,
/// F_dev, F_par.
void complete(std::vector<Observation>& rows, const Path& path, const PackingInfo& packing);

/// Reads the series of a test on `path` with `packing`. Columns may come in any order; those that are not required
/// (Column::required) may be missing: what follows from others is computed (eps_vol, eps_dev, shear_path, P_star,
/// s_dev, s_par, F_v, F_dev, F_par), the rest is undefined, so is the fabric where none of its columns is there. Throws InvalidInput naming file, row and column: unknown
/// column or unit, values that contradict each other (nu and strain, P_star and stress, ...), times that do not grow.
std::vector<Observation> read_series(const std::filesystem::path& file, const Path& path, const PackingInfo& packing);

}  // namespace grainlaw
