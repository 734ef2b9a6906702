#!/usr/bin/env bash
# full_resumes.sh: tests/full.sh on a tree of stages that only count how often they run: what has passed is not run again,
# what failed is, and changed sources are run anew; scripts that judge are no sources of what only builds and tests, nor of
# stages whose own script does not call them.
set -euo pipefail
script=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../full.sh")
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
cd "$tree"
fail() { echo "FAIL: $*" >&2; cat "$tree/build/said" >&2; exit 1; }

git init --quiet
mkdir -p tests/acceptance
cp "$script" tests/full.sh
printf '/build/\n' >.gitignore
printf '#!/bin/sh\n' >install-packages.sh
printf 'echo page >>build/ran; echo "page.seconds 1 <=2 ok"\n' >tests/acceptance/page.sh
printf 'echo law >>build/ran; echo "law.error 3 <=2 short"; test -e build/mended\n' >tests/acceptance/law.sh
chmod +x install-packages.sh

expect() { # code "stages that run" argument...
  local code=0
  : >build/ran
  tests/full.sh "${@:3}" >build/said 2>&1 || code=$?
  [[ $code == "$1" ]] || fail "exit code $code of full.sh ${*:3}, not $1"
  [[ $(paste -sd ' ' build/ran) == "$2" ]] || fail "full.sh ${*:3} ran '$(paste -sd ' ' build/ran)', not '$2'"
}
mkdir build
expect 2 "" nonsense
expect 0 "" --plan page law
expect 1 "page law" page law
grep -q '^| page | passed | 0 | 1 figures within bounds, 0 short |$' build/full/summary.md || fail "no line of page: $(cat build/full/summary.md)"
grep -q '^| law | failed | 0 | 0 figures within bounds, 1 short |$' build/full/summary.md || fail "no line of law: $(cat build/full/summary.md)"
grep -q '^law: law.error 3 <=2$' build/full/summary.md || fail "what is short is not named"
touch build/mended
expect 0 "law" page law
expect 0 "" page law
expect 0 "page law" --again page law
echo new >source
expect 0 "page" page
expect 0 "law" page law

# Of valgrind, which builds and tests, programs that only say so. Without git, too.
mkdir bin
for name in cmake valgrind; do printf '#!/bin/sh\nexit 0\n' >bin/$name; chmod +x bin/$name; done
printf '#!/bin/sh\necho valgrind >>build/ran\n' >tests/valgrind.sh
chmod +x tests/valgrind.sh
export PATH=$tree/bin:$PATH
for git in yes no; do
  if [[ $git == no ]]; then rm -rf .git; fi
  expect 0 "page valgrind" page valgrind
  echo '# a word' >>tests/acceptance/page.sh
  expect 0 "page" page valgrind
  echo '# a word' >>page.md
  expect 0 "" page valgrind
  echo newer >>source
  expect 0 "page valgrind" page valgrind
  echo '# a word' >>tests/acceptance/setup.sh
  expect 0 "page" page valgrind
  echo '# a word' >>tests/acceptance/law.sh
  expect 0 "" page valgrind
  echo '# calls door.sh' | tee -a tests/acceptance/page.sh >tests/acceptance/door.sh
  expect 0 "page" page valgrind
  echo '# a word' >>tests/acceptance/door.sh
  expect 0 "page" page valgrind
done
echo 'full_resumes: ok'
