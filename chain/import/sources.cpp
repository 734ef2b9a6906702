#include "chain/import/sources.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "chain/import/quantity.hpp"
#include "model/files/column.hpp"
#include "model/files/digest.hpp"
#include "model/files/one_line.hpp"
#include "model/vocabulary/error.hpp"

namespace grainlaw::chain {
namespace {

constexpr double kUndefined = Observation::undefined;

std::string component_of(const std::string& tensor, std::size_t c) { return tensor + "_" + kComponentName.at(c); }

std::string shown(const ForeignColumn& column) { return one_line(column.title, 60); }

TableLayout layout_of(const SeriesMapping& how) {
  constexpr std::array kCharacters{',', ';', '\t', ' '};
  return {how.delimiter ? kCharacters.at(static_cast<std::size_t>(*how.delimiter)) : '\0', how.array, how.names,
          how.decimal, how.skip};
}

}  // namespace

Sources::Sources(const Mapping& mapping, const TestMapping& test)
    : mapping_(mapping.name),
      table_(std::make_shared<ForeignTable>(read_foreign_table(test.series->file, layout_of(*test.series)))),
      sha256_(sha256_of_file(test.series->file)) {
  const SeriesMapping& how = *test.series;
  if (how.columns.empty())
    guess();
  else
    take(how.columns, fmt::format("{}: test {}", mapping_, test.name));
  drop_what_follows();
  require_all(how);
  set_units(how.units, test.packing->stress_unit());
}

void Sources::refuse(const std::string& why) const { throw InvalidInput(fmt::format("{}: {}", table_->name, why)); }

const ForeignColumn* Sources::find_column(const ColumnChoice& choice) const {
  if (choice.number > 0) {
    if (choice.number <= table_->columns.size()) return &table_->columns[choice.number - 1];
    refuse(fmt::format("has {} columns and no column {}; correct columns in {}", table_->columns.size(), choice.number,
                       mapping_));
  }
  for (const bool whole : {true, false}) {
    for (const ForeignColumn& column : table_->columns) {
      if ((whole ? column.title : parted(column.title).name) == choice.name) return &column;
    }
  }
  std::vector<std::string> titles;
  for (const ForeignColumn& column : table_->columns) titles.push_back(shown(column));
  refuse(fmt::format("has no column '{}', but {}; correct columns in {}", one_line(choice.name, 60),
                     fmt::join(titles, ", "), mapping_));
}

void Sources::take(const std::map<std::string, ColumnChoice>& columns, const std::string& where) {
  for (const auto& [name, choice] : columns) {
    if (find_quantity(name) == nullptr) {
      std::vector<std::string> known;
      for (const Quantity& quantity : quantities()) {
        if (known.empty() || known.back() != quantity.name) known.push_back(quantity.name);
      }
      throw InvalidInput(fmt::format("{}: series.columns.{}: is no quantity; give some of {}", where,
                                     one_line(name, 60), fmt::join(known, ", ")));
    }
    const ForeignColumn* column = find_column(choice);
    for (const auto& [other, source] : sources_) {
      if (source.column == column)
        throw InvalidInput(fmt::format("{}: series.columns: '{}' stands for {} and for {}; name one column for each",
                                       where, shown(*column), other, name));
    }
    sources_[name] = {column, 1, choice.unit.value_or(""), choice.unit.has_value()};
  }
}

void Sources::guess() {
  for (const ForeignColumn& column : table_->columns) {
    const Quantity* quantity = guessed(parted(column.title).name);
    if (quantity == nullptr) continue;
    const auto [other, fresh] = sources_.try_emplace(quantity->name, Source{&column, 1, "", false});
    if (!fresh)
      refuse(fmt::format("both columns '{}' and '{}' may be {} ({}); say with columns in {} which is",
                         shown(*other->second.column), shown(column), quantity->name, quantity->meaning, mapping_));
  }
}

bool Sources::has_tensor(const std::string& name) const {
  return has(name + "_xx") || has(name + "_yy") || has(name + "_zz");
}

bool Sources::has_edges() const { return has("Lx") || has("Ly") || has("Lz"); }

bool Sources::tells_volume() const { return has("nu") || has("void_ratio") || has("porosity"); }

/// Of two ways to say the same the richer one is read.
void Sources::drop_what_follows() {
  const auto drop = [&](bool given, std::initializer_list<const char*> others) {
    if (!given) return;
    for (const char* other : others) sources_.erase(other);
  };
  drop(has_tensor("strain"), {"Lx", "Ly", "Lz", "eps_a", "eps_v"});
  drop(has_edges(), {"eps_a", "eps_v"});
  drop(has_tensor("stress"), {"p", "q", "P_star"});
  drop(has("p"), {"P_star"});
  drop(has("nu"), {"void_ratio", "porosity"});
  drop(has("void_ratio"), {"porosity"});
  drop(has("C_star"), {"C"});
}

void Sources::require_tensor(const std::string& name, std::size_t components) const {
  for (std::size_t c = 0; c < components; ++c) {
    if (!has(component_of(name, c)))
      refuse(fmt::format("misses the column of {}; name it under columns in {}", component_of(name, c), mapping_));
  }
}

void Sources::require_all(const SeriesMapping& how) const {
  if (has_tensor("strain")) {
    require_tensor("strain", 3);
  } else if (has_edges()) {
    for (const char* edge : {"Lx", "Ly", "Lz"}) {
      if (!has(edge))
        refuse(fmt::format("misses the column of {}, where other edges are given; name it under columns in {}", edge,
                           mapping_));
    }
  } else if (!(has("eps_a") && has("eps_v")) && !(how.isotropic && (tells_volume() || has("eps_v")))) {
    refuse(
        fmt::format("misses the strain; name columns of strain_xx, strain_yy, strain_zz, or Lx, Ly, Lz, or eps_a and "
                    "eps_v in {} (or say \"isotropic\": true where the volume alone says it)",
                    mapping_));
  }
  if (has_tensor("stress"))
    require_tensor("stress", 3);
  else if (!has("p") && !has("P_star"))
    refuse(
        fmt::format("misses the stress; name columns of stress_xx, stress_yy, stress_zz, or p and q in {}", mapping_));
  else if (!has("q") && !how.isotropic)
    refuse(fmt::format("misses q beside the mean stress; name its column in {}, or say \"isotropic\": true", mapping_));
  if (tells_volume() && how.nu_start)
    refuse(fmt::format("tells the volume fraction in a column, and nu_start is given in {}; leave nu_start out",
                       mapping_));
  if (!tells_volume() && !how.nu_start)
    refuse(
        fmt::format("misses the volume fraction; name a column of nu, void_ratio or porosity in {}, or give nu_start, "
                    "that of the first row",
                    mapping_));
  if (has_tensor("fabric")) require_tensor("fabric", 6);
}

void Sources::set_units(const std::map<std::string, std::string>& units, double stress_unit) {
  for (auto& [name, source] : sources_) {
    const Quantity& quantity = *find_quantity(name);
    const bool stress = quantity.kind == UnitKind::stress;
    const auto of_kind = units.find(stress ? "stress" : quantity.kind == UnitKind::strain ? "strain" : "");
    if (const Title title = parted(source.column->title); source.declared)
      ;
    else if (title.unit)
      source.unit = *title.unit;
    else if (of_kind != units.end())
      source.unit = of_kind->second;
    else if (stress && stress_unit != 1)
      refuse(fmt::format("column '{}' ({}) has no unit; give \"units\": {{\"stress\": \"kPa\"}} or the like in {}",
                         shown(*source.column), name, mapping_));
    const bool starred = name == "P_star" || (stress && (source.unit.empty() || source.unit == "-"));
    const std::optional<double> factor = factor_of(starred ? UnitKind::number : quantity.kind, source.unit);
    if (!factor)
      refuse(fmt::format("column '{}' ({}): '{}' is no unit of it that is known; give one of {}", shown(*source.column),
                         name, one_line(source.unit, 20), known_units(quantity.kind)));
    if (stress && stress_unit == 1 && *factor != 1)
      refuse(fmt::format(
          "column '{}' ({}) is in {}, but the packing is dimensionless; give the packing's stress_unit in {}",
          shown(*source.column), name, source.unit, mapping_));
    source.factor = starred ? stress_unit : *factor;
  }
}

double Sources::value(std::size_t row, const std::string& quantity, bool may_be_undefined) const {
  const auto found = sources_.find(quantity);
  if (found == sources_.end()) return kUndefined;
  const ForeignColumn& column = *found->second.column;
  const double number = column.values[row];
  if (std::isfinite(number)) return number * found->second.factor;
  if (!column.bad.empty() && row >= column.bad_row)
    throw InvalidInput(
        fmt::format("{}: '{}' is no number; write it like 1.5e-3, with a decimal point, or as decimal in {} says",
                    place(column.bad_row, quantity), column.bad, mapping_));
  if (may_be_undefined && std::isnan(number)) return kUndefined;
  throw InvalidInput(fmt::format("{}: is {}; remove the row or repeat the test", place(row, quantity),
                                 std::isnan(number) ? "undefined" : "infinite"));
}

Eigen::Matrix3d Sources::tensor(std::size_t row, const std::string& name) const {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  for (std::size_t c = 0; c < kComponentName.size(); ++c) {
    if (has(component_of(name, c))) set_component(a, c, value(row, component_of(name, c)));
  }
  return a;
}

double Sources::volume_fraction(std::size_t row) const {
  if (has("nu")) return value(row, "nu");
  if (has("void_ratio")) return 1 / (1 + value(row, "void_ratio"));
  if (has("porosity")) return 1 - value(row, "porosity");
  return kUndefined;
}

std::string Sources::stress_column() const { return has_tensor("stress") ? "stress_xx" : has("p") ? "p" : "P_star"; }

std::string Sources::strain_column() const {
  for (const char* name : {"strain_xx", "Lx", "eps_a", "eps_v", "nu", "void_ratio", "porosity"}) {
    if (has(name)) return name;
  }
  return "";
}

std::string Sources::place(std::size_t row, const std::string& quantity) const {
  const auto source = sources_.find(quantity);
  if (source == sources_.end()) return table_->place(row);
  return fmt::format("{}, column '{}'", table_->place(row), shown(*source->second.column));
}

std::string Sources::place_of_ours(std::size_t row, const std::string& column) const {
  if (has(column)) return place(row, column);
  for (const char* tensor : {"strain", "stress", "fabric"}) {
    if (column.starts_with(tensor) && has(component_of(tensor, 0))) return place(row, component_of(tensor, 0));
  }
  if (column.starts_with("eps") || column.starts_with("strain")) return place(row, strain_column());
  if (column == "nu")
    return place(row, has("void_ratio") ? "void_ratio" : has("porosity") ? "porosity" : strain_column());
  if (column.starts_with("F_")) return place(row, "fabric_xx");
  if (column == "C_star") return place(row, "C");
  return place(row, column == "time" || column == "segment" ? "" : stress_column());
}

void Sources::describe(Positive stress, Positive strain, ForeignRows& foreign) const {
  std::vector<const ForeignColumn*> aside;
  for (const ForeignColumn& column : table_->columns) {
    const auto source = std::ranges::find_if(sources_, [&](const auto& s) { return s.second.column == &column; });
    if (source == sources_.end()) {
      const bool numbers = column.bad.empty();
      foreign.columns.push_back({column.title, numbers ? "" : "left out: not all of it are numbers", "", ""});
      if (numbers) aside.push_back(&column);
      continue;
    }
    const Quantity& quantity = *find_quantity(source->first);
    const bool of_stress = quantity.kind == UnitKind::stress || quantity.name == "P_star";
    foreign.columns.push_back({column.title, fmt::format("{} ({})", quantity.name, quantity.meaning),
                               source->second.unit,
                               of_stress                           ? to_string(stress)
                               : quantity.kind == UnitKind::strain ? to_string(strain)
                                                                   : ""});
  }
  foreign.notes.insert(foreign.notes.end(), table_->left_out.begin(), table_->left_out.end());
  for (const ForeignColumn* column : aside) foreign.extra.titles.push_back(column->title);
  for (std::size_t i = 0; i < rows() && !aside.empty(); ++i) {
    std::vector<double>& row = foreign.extra.rows.emplace_back();
    for (const ForeignColumn* column : aside)
      row.push_back(std::isfinite(column->values[i]) ? column->values[i] : kUndefined);
  }
  OrderedJson columns = OrderedJson::object();
  for (const auto& [name, source] : sources_)
    columns[name] = {{"column", one_line(source.column->title, 200)}, {"unit", source.unit}};
  foreign.provenance = {{"file", table_->name},
                        {"sha256", sha256_},
                        {"columns", columns},
                        {"positive", {{"stress", to_string(stress)}, {"strain", to_string(strain)}}}};
}

}  // namespace grainlaw::chain
