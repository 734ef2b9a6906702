#include "fit/prior_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/files/one_line.hpp"
#include "model/files/schema.hpp"
#include "model/files/whole_number.hpp"
#include "model/vocabulary/error.hpp"
#include "packing_prior_text.hpp"

namespace grainlaw::fit {
namespace {

constexpr double kSymmetric = 1e-9;  // of a correlation: sums in another order

}  // namespace

OrderedJson prior_to_json(const VariancePrior& prior) {
  OrderedJson names = OrderedJson::array(), degrees = OrderedJson::array(), matrix = OrderedJson::array();
  std::vector<Eigen::Index> known;
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!(prior.covariance(k, k) > 0)) continue;
    known.push_back(k);
    names.push_back(parameter_table()[i].name);
    degrees.push_back(prior.degrees_of_freedom(k));
  }
  for (const Eigen::Index k : known) {
    OrderedJson row = OrderedJson::array();
    for (const Eigen::Index l : known) row.push_back(prior.covariance(k, l));
    matrix.push_back(row);
  }
  return {{"packings", prior.size.packings},
          {"spheres", prior.size.spheres},
          {"names", names},
          {"degrees_of_freedom", degrees},
          {"covariance", matrix}};
}

VariancePrior prior_from_json(const Json& json, const std::string& name) {
  constexpr auto all = static_cast<Eigen::Index>(kParameterCount);
  VariancePrior prior{{}, Eigen::MatrixXd::Zero(all, all), Eigen::VectorXd::Constant(all, std::nan(""))};
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(fmt::format("{}: is no prior of grainlaw study prior: {}", name, one_line(why, 200)));
  };
  try {
    prior.size = {whole_number<int>(json.at("packings")), json.at("spheres")};
    const std::vector<std::string> names = json.at("names");
    const Json &degrees = json.at("degrees_of_freedom"), &matrix = json.at("covariance");
    if (degrees.size() != names.size() || matrix.size() != names.size())
      refuse("degrees_of_freedom and covariance need one entry for each of names");
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (std::ranges::none_of(parameter_table(), [&](const ParameterInfo& p) { return p.name == names[i]; }))
        refuse(fmt::format("names[{}]: '{}' is no parameter of the law", i, names[i]));
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(parameter_index(names[i]));
      prior.degrees_of_freedom(k) = degrees[i];
      if (!(prior.degrees_of_freedom(k) > 0)) refuse(fmt::format("degrees_of_freedom[{}]: must be positive", i));
      for (std::size_t j = 0; j < names.size(); ++j) {
        prior.covariance(k, static_cast<Eigen::Index>(parameter_index(names[j]))) = matrix.at(i).at(j);
        const double one = matrix.at(i).at(j), other = matrix.at(j).at(i);
        if (std::abs(one - other) >
            kSymmetric * std::sqrt(std::abs(matrix.at(i).at(i).get<double>() * matrix.at(j).at(j).get<double>())))
          refuse(fmt::format("covariance[{}][{}]: is not symmetric", i, j));
      }
    }
    prior.covariance = (prior.covariance / 2 + prior.covariance.transpose() / 2).eval();
    if (!(prior.size.spheres > 0 && prior.size.packings > 1)) refuse("packings and spheres must be positive");
  } catch (const Json::exception& error) {
    refuse(error.what());
  }
  return prior;
}

VariancePrior read_prior(const std::filesystem::path& file) {
  const Json document = read_json(file, JsonSource::own);
  const std::string name = one_line(file.string(), 200);
  check_schema(document, Schema::prior, name);
  return prior_from_json(document, name);
}

const VariancePrior& shipped_prior() {
  static const VariancePrior prior =
      prior_from_json(parse_json(kPackingPriorText, "the built-in prior", JsonSource::own), "the built-in prior");
  return prior;
}

}  // namespace grainlaw::fit
