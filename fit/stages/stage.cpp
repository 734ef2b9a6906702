#include "fit/stages/stage.hpp"

#include <algorithm>
#include <string_view>

#include "fit/statistics/profile.hpp"

namespace grainlaw::fit {

std::vector<std::string> parameters_of(const std::string& group) {
  std::vector<std::string> names;
  for (const ParameterInfo& info : parameter_table()) {
    if (std::string_view(info.name).starts_with(group + ".")) names.push_back(info.name);
  }
  return names;
}

StageDefinition left_out(const std::string& name, const std::vector<std::string>& parameters,
                         const std::string& remedy) {
  StageDefinition stage;
  stage.name = name;
  stage.window = "left out: " + remedy;
  for (const std::string& parameter : parameters)
    stage.absent.push_back({parameter, {0, kUndefined, Status::not_identified, remedy}});
  return stage;
}

Problem problem_of(const StageDefinition& stage, LawParameters<double> law, Loss loss) {
  if (stage.start) stage.start(law);
  Problem problem;
  const auto value = fields(law);
  for (const std::string& name : stage.free) {
    FreeParameter p = free_parameter(name, *value[parameter_index(name)]);
    if (name.ends_with(".nu_c")) p.upper = std::max(p.lower, std::min(p.upper, stage.least_nu - kNearestJamming));
    problem.parameters.push_back(p);
  }
  problem.blocks = stage.blocks(law);
  problem.loss = loss;
  return problem;
}

StageFit run_stage(const StageDefinition& stage, LawParameters<double>& law, const CalibrationOptions& options,
                   const RunControl& control, const FoundErrors& found) {
  StageFit fit;
  if (stage.blocks) {
    const Problem problem = problem_of(stage, law, options.loss);
    fit = fit_stage(stage.name, stage.window, problem, stage.remedy, options.threads, control,
                    stage.coupled ? options.starts : 1);
    if (fit.solution.defined) {
      const auto field = fields(law);
      for (std::size_t k = 0; k < stage.free.size(); ++k)
        *field[parameter_index(stage.free[k])] = fit.solution.x(static_cast<Eigen::Index>(k));
      inherit_errors(stage.given, found, law, stage.blocks, options.threads, fit);
      if (stage.judge) stage.judge(fit, law);
      if (stage.profiled && options.profiles) profile_doubtful(problem, options.threads, control, fit);
    }
  } else {
    fit.stage.name = stage.name;
    fit.stage.window = stage.window;
    fit.stage.termination = "left out";
    fit.stage.converged = true;
  }
  fit.stage.estimates.insert(fit.stage.estimates.end(), stage.absent.begin(), stage.absent.end());
  return fit;
}

}  // namespace grainlaw::fit
