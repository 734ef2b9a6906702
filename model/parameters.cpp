#include "model/parameters.hpp"

#include "model/vocabulary/error.hpp"

namespace grainlaw {

std::size_t parameter_index(const std::string& name) {
  const auto& table = parameter_table();
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (name == table[i].name) return i;
  }
  throw InvalidInput("parameters: '" + name + "' is no parameter of the law; see docs/formats.md for the names");
}

LawParameters<double> start_parameters() {
  LawParameters<double> p;
  const auto to = fields(p);
  for (std::size_t i = 0; i < kParameterCount; ++i) *to[i] = parameter_table()[i].start;
  return p;
}

LawParameters<double> published_parameters() {
  LawParameters<double> p = start_parameters();
  const auto to = fields(p);
  for (std::size_t i = 0; i < kParameterCount; ++i) *to[i] = parameter_table()[i].published.value_or(*to[i]);
  return p;
}

LawParameters<double> published_parameters(const std::string& mode) {
  LawParameters<double> p = published_parameters();
  if (mode == "UNI") p.isotropic = {{8.3700, 0.5998, 0.6625}, {0.1507, 15.6835}, {0.04006, 0.03270, 0.6619}};
  if (mode.starts_with("D3")) p.steady = {{7.9289, 0.5764, 0.6603}, {0.1327, 14.6813}, {0.03899, 0.02819, 0.6583}};
  return p;
}

}  // namespace grainlaw
