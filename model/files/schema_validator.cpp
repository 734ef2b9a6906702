#include "model/files/schema_validator.hpp"

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace grainlaw {

Violation first_violation(const Json& document, const Json& schema) {
  valijson::Schema compiled;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(schema), compiled);
  valijson::ValidationResults results;
  if (valijson::Validator().validate(compiled, valijson::adapters::NlohmannJsonAdapter(document), &results)) return {};
  Violation violation{true, {}};
  valijson::ValidationResults::Error error;
  if (!results.popError(error)) return violation;
  for (std::size_t i = 1; i < error.context.size(); ++i) {  // the first element is "<root>"
    const std::string& part = error.context[i];             // "[key]"
    violation.place.push_back(part.size() >= 2 && part.front() == '[' ? part.substr(1, part.size() - 2) : part);
  }
  return violation;
}

}  // namespace grainlaw
