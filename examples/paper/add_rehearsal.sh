#!/usr/bin/env bash
# examples/paper/add_rehearsal.sh FOLDER [NAME]: ships the runs in FOLDER, a prediction made with --dem or a data set of one path,
# as the rehearsal NAME (default: FOLDER's) beside the shipped data: data/dataset/rehearsals/NAME. Thinned to the columns that a
# data set needs and to at most 80 rows of each run besides the ends of its segments. Needs jq.
set -euo pipefail

folder=$(realpath "$1")
name=${2:-$(basename "$folder")}
out=$(realpath "$(dirname "${BASH_SOURCE[0]}")")/data/dataset/rehearsals/$name
[[ -f $folder/dataset.json ]] || folder=$folder/dem
mkdir -p "$out"

for run in $(jq -r '.tests[].name' "$folder/dataset.json"); do
  # numbers to nine digits: far below the scatter of anything, and a row must stay on its path
  awk -F, -v OFS=, -v rows=80 '
    NR == 1 {
      wanted = "^(time\\[s\\]|segment|strain_.*|nu|stress_(xx|yy|zz|yz|xz|xy)\\[Pa\\]|fabric_.*|C_star|rattler_fraction|C)$"
      for (i = 1; i <= NF; i++) if ($i ~ wanted) { column[++columns] = i; exact[columns] = ($i ~ /^(time|segment|strain|nu)/) }
    }
    {
      line = ""
      for (c = 1; c <= columns; c++) {
        value = $(column[c])
        if (NR > 1 && !exact[c] && value != "") value = sprintf("%.9g", value)
        line = line (c > 1 ? OFS : "") value
      }
      all[NR] = line; segment[NR] = $2
    }
    END {
      every = int((NR - 2) / rows) + 1
      for (i = 1; i <= NR; i++)
        if (i <= 2 || i == NR || segment[i] != segment[i + 1] || (i - 2) % every == 0) print all[i]
    }' "$folder/$run.csv" >"$out/$run.csv"
done
jq '{format, format_version, spec, provenance: (.provenance | del(.command)),
     tests: [.tests[] | {name, role: "rehearsal", path, packing}]} | with_entries(select(.value != null))' \
  "$folder/dataset.json" >"$out/dataset.json"
du -sh "$out"
