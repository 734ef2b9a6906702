# Sourced by the acceptance scripts: one line per figure, "NAME VALUE BOUND ok|short".
# A bound is "<=X", ">=X" or "stated" (reported, not judged); a value that is no number is short.

short_figures=0

figure() { # name value bound
  local verdict
  verdict=$(awk -v value="$2" -v bound="$3" 'BEGIN {
    number = value ~ /^[-+]?[0-9]*\.?[0-9]+([eE][-+]?[0-9]+)?$/
    limit = substr(bound, 3) + 0
    if (!number) ok = 0
    else if (bound ~ /^<=/) ok = value + 0 <= limit
    else if (bound ~ /^>=/) ok = value + 0 >= limit
    else ok = bound == "stated"
    print ok ? "ok" : "short"
  }')
  printf '%s %s %s %s\n' "$1" "$2" "$3" "$verdict"
  if [[ $verdict != ok ]]; then short_figures=$((short_figures + 1)); fi
}

# Figures that tests measure and print as "figure NAME VALUE BOUND", meaning VALUE <= BOUND. Those of a missing or
# failing executable are reported as short under the names given.
figures_of_tests() { # executable gtest-filter expected-name-prefix...
  local executable=$1 filter=$2 lines prefix
  shift 2
  lines=$("$executable" --gtest_filter="$filter" 2>/dev/null | grep '^figure ' || true)
  while read -r _ name value bound; do
    if [[ -n ${name:-} ]]; then figure "$name" "$value" "<=$bound"; fi
  done <<<"$lines"
  for prefix in "$@"; do
    if ! grep -q "^figure $prefix" <<<"$lines"; then figure "$prefix" missing stated; fi
  done
}

finish_figures() {
  if ((short_figures > 0)); then
    echo "$short_figures figures are short" >&2
    exit 1
  fi
}
