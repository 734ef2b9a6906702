#!/usr/bin/env bash
# Sows one violation at a time into a small clean tree: each check must name it, and must pass
# the clean tree.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
tree=$folder/clean
failures=0

make_clean_tree() {
  mkdir -p "$tree"/{model/vocabulary,model/files,dem/engine/lanes,dem/statics,dem/element_tests,dem/runs}
  mkdir -p "$tree"/{fit/{data,statistics,stages},predict/{solvers,studies},chain,app,tests/unit}
  echo '#include <Eigen/Core>' >"$tree/model/vocabulary/tensor.hpp"
  echo '#include "model/vocabulary/tensor.hpp"' >"$tree/model/vocabulary/path.hpp"
  echo '#include "model/vocabulary/path.hpp"' >"$tree/model/files/path_file.hpp"
  echo '#include "model/files/path_file.hpp"' >"$tree/model/law.hpp"
  printf '#include "model/vocabulary/path.hpp"\n#include "dem/engine/lanes/lanes.hpp"\n' >"$tree/dem/engine/packing.hpp"
  echo '#include "dem/engine/packing.hpp"' >"$tree/dem/engine/lanes/lanes.hpp"
  printf '#include "dem/engine/packing.hpp"\n#include <vector>\n' >"$tree/dem/engine/packing.cpp"
  echo '#include "dem/engine/lanes/lanes.hpp"' >"$tree/dem/statics/relax.hpp"
  echo '#include "dem/statics/relax.hpp"' >"$tree/dem/element_tests/drive.hpp"
  echo '#include "model/law.hpp"' >"$tree/fit/statistics/problem.hpp"
  echo '#include "fit/statistics/problem.hpp"' >"$tree/fit/data/options.hpp"
  printf '#include "fit/data/options.hpp"\n#include "fit/statistics/problem.hpp"\n' >"$tree/fit/stages/stage.hpp"
  printf '#include "fit/stages/stage.hpp"\n#include <ceres/ceres.h>\n' >"$tree/fit/calibrate.cpp"
  printf '#include "model/law.hpp"\n' >"$tree/fit/calibrate.hpp"
  printf '#include "model/law.hpp"\n#include <cvodes/cvodes.h>\n' >"$tree/predict/predict.cpp"
  echo '#include "model/vocabulary/tensor.hpp"' >"$tree/predict/solvers/cvode.hpp"
  printf '#include "model/law.hpp"\n#include "predict/solvers/cvode.hpp"\n' >"$tree/predict/predict.hpp"
  echo '#include "predict/predict.hpp"' >"$tree/predict/studies/walker.hpp"
  echo '#include "dem/element_tests/drive.hpp"' >"$tree/dem/runs/runs.hpp"
  echo '#include <grainlaw_build_info.hpp>' >"$tree/model/files/execution.cpp"
  printf '#include "fit/calibrate.hpp"\n#include "dem/runs/runs.hpp"\n' >"$tree/chain/calibration.hpp"
  printf '#include "chain/calibration.hpp"\n#include "dem/engine/packing.hpp"\n' >"$tree/app/commands.cpp"
  seq 400 | sed 's|^|// |' >"$tree/tests/unit/tensor_test.cpp"
  mkdir -p "$tree/docs/theory"
  printf 'See `model/law.hpp`, `dem/engine/packing`, `fit/*.hpp` and `tests/unit/tensor_test.cpp --all`.\n' >"$tree/README.md"
  printf '```sh\nfit/calibrate.cpp # [index](theory/index.md)\n```\n[index](theory/index.md#here)\n' >"$tree/docs/page.md"
  printf '<!-- begin %s -->\n| key |\n|---|\n| `%s` | x |\n<!-- end %s -->\n' parameters law.G parameters \
    'series columns' 'stress_xx[Pa]' 'series columns' >"$tree/docs/formats.md"
  printf '`law.G` `stress_xx[Pa]`\n## Wide weights\n## Ends\n' >"$tree/docs/theory/index.md"
  printf '// Formulas: docs/theory/index.md, sections Wide\n// weights and Ends.\n' >>"$tree/fit/calibrate.hpp"
}

clean_tree() {
  rm -rf "$folder/tree"
  cp -r "$folder/clean" "$folder/tree"
}

# expect CHECK PATTERN: CHECK must fail and name the PATTERN.
expect() {
  local output
  if output=$(bash "$here/$1" "$tree"); then
    printf 'not caught by %s: %s\n' "$1" "$2"
    failures=$((failures + 1))
  elif ! grep -qF "$2" <<<"$output"; then
    printf '%s failed without naming "%s":\n%s\n' "$1" "$2" "$output"
    failures=$((failures + 1))
  fi
}

# sow FILE INCLUDE PATTERN: adds one forbidden include to the clean tree.
sow() {
  clean_tree
  echo "#include $2" >>"$tree/$1"
  expect check_includes.sh "$3"
}

make_clean_tree
tree=$folder/tree
clean_tree
for check in check_includes.sh check_files.sh check_docs.sh; do
  if ! bash "$here/$check" "$tree"; then
    echo "$check refuses the clean tree"
    failures=$((failures + 1))
  fi
done

sow model/law.hpp '"dem/engine/packing.hpp"' 'model must not include dem/engine'
sow dem/engine/packing.hpp '"fit/calibrate.hpp"' 'dem/engine must not include fit'
sow dem/engine/packing.cpp '"model/law.hpp"' 'dem/engine must not include model'
sow dem/engine/packing.cpp '"dem/statics/relax.hpp"' 'dem/engine must not include dem/statics'
sow dem/engine/lanes/lanes.hpp '"dem/element_tests/drive.hpp"' 'dem/engine must not include dem/element_tests'
sow dem/statics/relax.hpp '"dem/element_tests/drive.hpp"' 'dem/statics must not include dem/element_tests'
sow model/vocabulary/path.hpp '"model/law.hpp"' 'model/vocabulary must not include model'
sow model/files/path_file.hpp '"model/law.hpp"' 'model/files must not include model'
sow fit/statistics/problem.hpp '"fit/stages/stage.hpp"' 'fit/statistics must not include fit/stages'
sow fit/statistics/problem.hpp '"fit/data/options.hpp"' 'fit/statistics must not include fit/data'
sow fit/data/options.hpp '"fit/stages/stage.hpp"' 'fit/data must not include fit/stages'
sow fit/stages/stage.hpp '"fit/calibrate.hpp"' 'fit/stages must not include fit '
sow fit/calibrate.cpp '"predict/predict.hpp"' 'fit must not include predict'
sow predict/predict.cpp '"fit/calibrate.hpp"' 'predict must not include fit'
sow predict/solvers/cvode.hpp '"predict/predict.hpp"' 'predict/solvers must not include predict'
sow predict/solvers/cvode.hpp '"model/law.hpp"' 'predict/solvers must not include model'
sow predict/predict.cpp '"predict/studies/walker.hpp"' 'predict must not include predict/studies'
sow fit/calibrate.cpp '"dem/engine/packing.hpp"' 'fit must not include dem'
sow fit/calibrate.hpp '"app/commands.hpp"' 'fit must not include app'
sow fit/calibrate.hpp '"chain/calibration.hpp"' 'fit must not include chain'
sow chain/calibration.hpp '"app/commands.hpp"' 'chain must not include app'
sow dem/element_tests/drive.hpp '"dem/runs/runs.hpp"' 'dem/element_tests must not include dem/runs'
sow fit/calibrate.hpp '<ceres/ceres.h>' 'belongs to fit/*.cpp only'
sow predict/predict.cpp '<ceres/ceres.h>' 'belongs to fit/*.cpp only'
sow app/commands.cpp '<cvodes/cvodes.h>' 'belongs to predict/*.cpp only'
sow fit/calibrate.cpp '<nvector/nvector_serial.h>' 'belongs to predict/*.cpp only'
sow dem/engine/packing.cpp '"grainlaw_build_info.hpp"' 'belongs to model/*.cpp only'
sow dem/engine/packing.cpp 'MACRO' 'cannot read this include'
sow dem/engine/packing.cpp '"packing.hpp"' 'is not of the form'
sow dem/engine/packing.cpp '"../model/law.hpp"' 'is not of the form'
sow dem/engine/packing.cpp '<model/vocabulary/path.hpp>' 'write it in quotes'
sow app/commands.cpp '"dem/no_such_file.hpp"' 'does not exist'
sow app/commands.cpp '"tests/unit/tensor_test.cpp"' 'is not of the form'

clean_tree
echo '// one line more' >>"$tree/tests/unit/tensor_test.cpp"
expect check_files.sh '401 lines'
for name in dem/utils.hpp app/string_utils.cpp model/common.hpp tests/helpers.hpp fit/util/a.cpp; do
  clean_tree
  mkdir -p "$(dirname "$tree/$name")"
  touch "$tree/$name"
  expect check_files.sh "$name: name it after"
done

clean_tree
echo 'OrderedJson document;' >>"$tree/fit/calibrate.cpp"
expect check_files.sh 'begin it as OrderedJson::object'
clean_tree
echo 'std::istringstream words(text);' >>"$tree/fit/calibrate.cpp"
expect check_files.sh 'follow it by words.exceptions(std::ios::badbit);'
clean_tree
echo 'return view.render(root);' >>"$tree/fit/calibrate.cpp"
expect check_files.sh 'render into a string by a function'

# sow_text PAGE TEXT PATTERN: adds a line to a page.
sow_text() {
  clean_tree
  printf '%s\n' "$2" >>"$tree/$1"
  expect check_docs.sh "$3"
}
sow_text README.md 'and `dem/no_such_file.hpp`' 'README.md: names dem/no_such_file.hpp'
sow_text README.md 'and `tests/run.sh --full`' 'names tests/run.sh'
sow_text README.md $'and `over the end\nmodel/of_a_line.hpp`' 'names model/of_a_line.hpp'
sow_text docs/page.md $'```sh\nexamples/none/run.sh OUT\n```' 'docs/page.md: names examples/none/run.sh'
sow_text docs/theory/index.md '`predict/*.md`' 'names predict/*.md'
sow_text docs/theory/index.md '[law](law.md)' 'docs/theory/index.md: links to law.md'
sow_text fit/calibrate.hpp '// docs/theory/index.md, section Loss.' 'fit/calibrate.hpp: names section "Loss" of docs/theory/index.md'
clean_tree
echo '`law.G`' >"$tree/docs/theory/index.md"
expect check_docs.sh 'leaves out `stress_xx[Pa]`'
clean_tree
echo '`stress_xx[Pa]`' >"$tree/docs/theory/index.md"
expect check_docs.sh 'leaves out `law.G`'

rm -rf "${tree:?}"/*
expect check_includes.sh '0 files'
expect check_docs.sh '0 pages'
expect check_files.sh '0 files'

printf '%d failures\n' "$failures"
((failures == 0))
