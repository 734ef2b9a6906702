# The installed tree: complete, movable, and usable by a project that knows nothing but its prefix.
set -euo pipefail
grainlaw=$1
source=$GRAINLAW_SOURCE_DIR build=$GRAINLAW_BUILD_DIR
fail() { echo "FAIL: $*" >&2; exit 1; }
cached() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; }

cmake --install "$build" --prefix "$PWD/first" >log || fail "$(cat log)"
mv first moved
for file in bin/grainlaw lib/libgrainlaw_{model,dem,fit,predict,chain}.a lib/cmake/grainlaw/grainlaw-config.cmake \
  include/grainlaw/dem/element_tests/element_run.hpp share/doc/grainlaw/{LICENSE,CITATION.cff,README.md} \
  share/doc/grainlaw/docs/formats.md share/doc/grainlaw/docs/schemas/spec.schema.json; do
  [[ -s moved/$file ]] || fail "not installed: $file"
done
[[ ! -e moved/include/grainlaw/app ]] || fail "app is no library for others"

# A debug build keeps the paths of its sources for the debugger, in its binaries only.
binaries=()
[[ $(cached CMAKE_BUILD_TYPE) == Release ]] || binaries=(-I)
for path in "$source" "$build" "$PWD/first"; do
  ! grep -rlF "${binaries[@]}" "$path" moved >found || fail "$path is named in $(cat found)"
done
! grep -rlE '#include <(ceres|cvodes?|nvector|sun[a-z]+|sundials|Random123|valijson)/' moved/include >found ||
  fail "headers that no user has to have, in $(cat found)"

# As in an account that never saw the build: no variables, another home, only the compiler and the generator alike.
clean() { env -i PATH=/usr/local/bin:/usr/bin:/bin HOME="$PWD" "$@"; }
clean moved/bin/grainlaw --version >version || fail "the program does not start"
cp -r "$source/tests/install/consumer" .
configure() { # BUILD_FOLDER
  clean cmake -S consumer -B "$1" -G "$(cached CMAKE_GENERATOR)" -D CMAKE_CXX_COMPILER="$(cached CMAKE_CXX_COMPILER)" \
    -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH="$PWD/moved" >log 2>&1
}
configure built || fail "$(cat log)"
clean cmake --build built >log 2>&1 || fail "$(cat log)"
sed -i 's/find_package(grainlaw 0.1/find_package(grainlaw 0.2/' consumer/CMakeLists.txt
! configure refused || fail "version 0.1 passes for 0.2"
grep -q 'requested version "0.2"' log || fail "$(cat log)"

clean built/links_fit >text || fail "the calibration does not refuse an empty data set: $(cat text)"
clean built/consumer >text || fail "$(cat text)"
expect() { # NAME LOWER UPPER
  awk -v name="$1" -v lower="$2" -v upper="$3" '
    $1 == name { found = 1; ok = $2 ~ /^-?[0-9.]+(e[-+][0-9]+)?$/ && $2 + 0 >= lower + 0 && $2 + 0 <= upper + 0 }
    END { exit !(found && ok) }' text || fail "$1 is not in [$2, $3]: $(cat text)"
}
expect dem.rows 21 21
expect dem.nu_change 0 1e-12            # D2 keeps the volume
expect dem.eps_dev 0.049999999 0.050000001
expect dem.P_star 0.01 0.1              # a jammed packing of few, fast grains
expect dem.s_par 0.01 1                 # shear stress follows the shear
expect dem.energy_residual 0 1e-2
expect law.rows 11 11
expect law.nu_ratio_log 0.049999999 0.050000001  # UNI: -d eps_vol = d eps_dev
expect law.P_star_start 1e-3 0.02
awk '$1 == "law.P_star_start" { a = $2 } $1 == "law.P_star_end" { b = $2 } END { exit !(b > a) }' text || fail "$(cat text)"
expect law.s_par 0.01 0.3
expect law.F_par 0.01 0.3
