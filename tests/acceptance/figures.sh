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

# Least of three times of a fixed piece of work that is not ours, on one core of this machine now [s].
yardstick() {
  local begin
  for _ in 1 2 3; do
    begin=$EPOCHREALTIME
    perl -e '$sum += sqrt($_) for 1 .. 4000000'
    awk -v a="$begin" -v b="$EPOCHREALTIME" 'BEGIN { print b - a }'
  done | sort -g | head -1
}

# A time, and how many yardsticks it is: the bound is on those, so that it holds on a faster machine and in a slower hour.
figure_of_time() { # name seconds bound
  figure "$1.seconds" "$2" stated
  figure "$1.yardsticks" "$(awk -v seconds="$2" -v yardstick="$(yardstick)" 'BEGIN {
    print (seconds + 0 > 0 ? sprintf("%.4g", seconds / yardstick) : "missing") }')" "$3"
}

# Figures that tests measure and print as "figure NAME VALUE BOUND", meaning VALUE <= BOUND. Those of a missing or
# failing executable are reported as short under the names given.
figures_of_tests() { # executable gtest-filter expected-name-prefix...
  local executable=$1 filter=$2 lines prefix
  shift 2
  lines=$(tests_by_filter "$executable" "$filter" | grep -E '^figure( [^ ]+){3}$' || true)
  while read -r _ name value bound; do
    if [[ -n ${name:-} ]]; then figure "$name" "$value" "<=$bound"; fi
  done <<<"$lines"
  for prefix in "$@"; do
    if ! grep -q "^figure $prefix" <<<"$lines"; then figure "$prefix" missing stated; fi
  done
}

# Largest relative difference between our curve and the published one where the density lies in [from, to].
curve_error() { # calibration.json quantity from to
  jq -r --arg quantity "$2" --argjson from "$3" --argjson to "$4" '
    [.curves[] | select(.quantity == $quantity and .nu >= $from - 1e-9 and .nu <= $to + 1e-9)
               | (.ours - .published) / .published | fabs] | if length > 0 then max else "missing" end' "$1"
}

# A value that a script or test printed as "NAME VALUE", "missing" otherwise.
value_of() { # name file
  awk -v name="$1" '$1 == name { value = $2 } END { print value == "" ? "missing" : value }' "$2"
}

finish_figures() {
  if ((short_figures > 0)); then
    echo "$short_figures figures are short" >&2
    exit 1
  fi
}
