# Sourced by the examples' run.sh: the build, and the chain on the inputs of one folder.

# build_grainlaw: installs what is missing and builds Release, in the top folder, where it leaves the shell.
build_grainlaw() {
  cd "$(dirname "${BASH_SOURCE[0]}")/.."
  ./install-packages.sh
  cmake --preset release --log-level=WARNING
  cmake --build build/release --target grainlaw --parallel "$(nproc)"
}

# run_chain INPUTS OUT OPTION...: installs what is missing, builds Release, then spec.json -> law, every other JSON file of
# INPUTS -> prediction with these options, all of it -> report. The summary goes to standard output.
run_chain() {
  local inputs out cost path summary
  inputs=$(realpath "$1")
  out=$(realpath -m "$2")
  shift 2
  build_grainlaw

  mkdir -p "$out"
  cost=$(mktemp)
  # shellcheck disable=SC2064 # the name of now
  trap "rm -f '$cost'" EXIT

  # Runs grainlaw and notes its seconds and peak memory in kB.
  grainlaw() {
    echo "== grainlaw $*" >&2
    command time --quiet --append --output "$cost" --format '%e %M' build/release/bin/grainlaw "$@"
  }

  grainlaw calibrate "$inputs/spec.json" -o "$out"
  for path in "$inputs"/*.json; do
    if [[ $path == */spec.json ]]; then continue; fi
    grainlaw predict "$out/parameters.json" "$path" "$@" -o "$out/predictions/$(basename "$path" .json)"
  done
  summary=$(grainlaw report "$out" -o "$out/report.html")

  awk '{ seconds += $1; if ($2 > peak) peak = $2 }
       END { printf "\nWhole chain after the build: %.0f s, peak memory %.0f MB\n\n", seconds, peak / 1024 }' "$cost"
  printf '%s\n' "$summary"
}
