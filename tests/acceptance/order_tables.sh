#!/usr/bin/env bash
# tests/acceptance/order_tables.sh [EXECUTABLE...]: runs test executables (default: verification_dem and
# verification_predict of build/release, which must be built) and writes the tables of errors that they print,
#   table NAME | cell | cell
# to docs/order-of-accuracy.md. Fails when a test fails or a table has no caption here.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
executables=("$@")
if (($# == 0)); then executables=(build/release/bin/verification_dem build/release/bin/verification_predict); fi

# In the order of the document.
captions=(
  "D1.damped|Restitution of a head-on pair (r = 1 mm, gamma = 1 kg/s) over 2000 random phases, t_c/dt within 1/2 around the value and never whole: order 1, because the viscous force jumps when a contact begins and ends."
  "D1.damped_smallest|The same for the paper's smallest pair (r = 0.5 mm), which is damped more."
  "D1.undamped|The same without damping (r = 1 mm): no jump, order 2."
  "D1.closed|Two damped contacts that never open (r = 1 mm, gamma = 1 kg/s) over three periods: no jump, so order 2 with damping too."
  "D2.trap|The trap: with t_c/dt whole, the errors at both ends of a contact cancel (phases 0.1 to 0.9), and a study would report order 2 where it is 1."
  "D9.order|Residual of the energy balance over the dissipation of eight shaken, jammed packings (N = 100, nu = 0.75) compressed by 1 %: order 2."
  "precision|The force of a sphere over the mean contact force, and P* of a packing, in mixed and in double precision: errors against plain loops."
  "O1.cvode|Eqs. 17 and 18 by CVODE against the closed form: error against the tolerance asked for."
  "O5.cvode|The same for Eq. 16 with a manufactured solution."
)

lines=$(mktemp)
trap 'rm -f "$lines"' EXIT
for executable in "${executables[@]}"; do
  log=$("$executable" --gtest_brief=1 2>&1) || { printf '%s\n' "$log" >&2; echo "$executable: tests fail" >&2; exit 1; }
  sed -n 's/^table //p' <<<"$log" >>"$lines"
done

known=" "
for caption in "${captions[@]}"; do known+="${caption%%|*} "; done
for name in $(cut -d' ' -f1 "$lines" | sort -u); do
  if [[ $known != *" $name "* ]]; then
    echo "table $name: give it a caption in ${BASH_SOURCE[0]}" >&2
    exit 1
  fi
done

document=docs/order-of-accuracy.md
{
  echo "# Order of accuracy"
  echo
  echo "Measured by the tests themselves, which assert the orders, and written by \`tests/acceptance/order_tables.sh\`."
  for caption in "${captions[@]}"; do
    name=${caption%%|*}
    if ! grep -q "^$name |" "$lines"; then continue; fi
    printf '\n## %s\n%s\n\n' "$name" "${caption#*|}"
    awk -v name="$name" '$1 == name {
      sub(/^[^|]*/, ""); sub(/ *$/, ""); print $0 " |"
      if (!seen++) { gsub(/[^|]/, ""); gsub(/\|/, "|---"); print $0 "|" }
    }' "$lines"
  done
} >"$document.new"
mv "$document.new" "$document"
echo "$document: $(cut -d' ' -f1 "$lines" | sort -u | wc -l) tables"
