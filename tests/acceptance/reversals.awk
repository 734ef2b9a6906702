# The reversals of a cyclic path, from one CSV for each seed of one kind (DEM, or the law at the rows of DEM), averaged row by
# row: for each segment after the first "segment K s STRAIN F STRAIN P LEAST": shear strain from the corner to the sign change
# of s_par and of F_par, and the least P_star over that at the corner.
BEGIN { FS = "," }
FNR == 1 { row = 0; seeds++; for (i = 1; i <= NF; i++) column[$i] = i; next }
{ k = row++; segment[k] = $column["segment"]; path[k] = $column["shear_path"]
  s[k] += $column["s_par"]; F[k] += $column["F_par"]; P[k] += $column["P_star"]; if (row > rows) rows = row }
function change(v, from, to,   k) { # strain from the corner `from` to the sign change of v
  for (k = from + 1; k <= to; k++)
    if (v[k] * v[from] <= 0) return path[k - 1] + (path[k] - path[k - 1]) * v[k - 1] / (v[k - 1] - v[k]) - path[from]
  return "missing"
}
END {
  for (k = 1; k < rows; k++) {
    if (segment[k] == segment[k - 1]) continue
    from = k - 1
    for (to = k; to + 1 < rows && segment[to + 1] == segment[k]; ) to++
    least = 1
    for (i = from; i <= to; i++) if (P[i] / P[from] < least) least = P[i] / P[from]
    print "segment", segment[k], "s", change(s, from, to), "F", change(F, from, to), "P", least
  }
}
