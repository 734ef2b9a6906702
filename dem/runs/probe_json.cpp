#include "dem/runs/probe_json.hpp"

namespace grainlaw::dem {
namespace {

constexpr double kStep = 1e-6;

}  // namespace

ProbePlan probes_from_json(const Json& object) {
  ProbePlan plan{object.at("every").get<double>(), {kStep}};
  if (object.contains("step")) {
    const Json& step = object["step"];
    plan.steps = step.is_array() ? step.get<std::vector<double>>() : std::vector<double>{step.get<double>()};
  }
  return plan;
}

OrderedJson probes_to_json(const ProbePlan& plan) { return {{"every", plan.every}, {"step", plan.steps}}; }

}  // namespace grainlaw::dem
