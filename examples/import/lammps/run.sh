#!/usr/bin/env bash
# examples/import/lammps/run.sh OUT [MU] [SEEDS] [N]: element tests by LAMMPS (Debian's package lammps), one core.
# MU friction (0, 0.1 or 0.5), SEEDS one packing each ("1 2 3"), N spheres of a packing (1000); finished tests are kept.
# Makes OUT/muMU/packing-SEED/NAME.csv with the box and the stress, and the spheres and contacts of each row beside it.
set -euo pipefail

out=$1 mu=${2:-0} seeds=${3:-1 2 3} N=${4:-1000}
deck=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
rate=276 frames=50 dumps=1  # 1/s, rows of a segment, 1: spheres and contacts with each row

case $mu in
0) nu_start=0.64 nu_end=0.66 shear="0.68 0.71 0.75 0.80" triaxial="0.71 0.80" compressed="0.71 0.75" uniaxial="0.70 0.73" ;;
0.1) triaxial="" nu_start=0.60 nu_end=0.63 shear="0.66 0.69 0.73 0.79" compressed="0.69 0.73" uniaxial="0.68 0.71" ;;
0.5) triaxial="" nu_start=0.55 nu_end=0.575 shear="0.62 0.66 0.71 0.78" compressed="0.66 0.71" uniaxial="0.64 0.68" ;;
*) echo "run.sh: MU must be 0, 0.1 or 0.5" >&2 && exit 2 ;;
esac
keep="$(printf '%s\n' $shear $uniaxial | sort -ru) 0"

# lammps NAME INPUT [-var ...]: unless NAME is done.
lammps() {
  local name=$1 input=$2
  shift 2
  [ -e "$folder/$name.done" ] && return
  rm -f "$folder/$name".{csv,spheres.dump,contacts.dump}
  OMPI_MCA_btl=self OMP_NUM_THREADS=1 lmp -in "$deck/$input" -screen none -log "$folder/$name.log" -var deck "$deck" \
    -var out "$folder" -var name "$name" -var mu "$mu" -var rate $rate -var frames $frames -var dumps $dumps "$@" </dev/null
  rm -f "$folder/$name.log"
  touch "$folder/$name.done"
}
# strain NAME MODE NU EXTENT [THEN_NU]
strain() {
  lammps "$1" element_test.in -var start "$folder/ISO.$3.restart" -var nu "$3" -var mode "$2" -var extent "$4" -var then_nu "${5:-0}"
}

for seed in $seeds; do
  folder=$out/mu$mu/packing-$seed
  mkdir -p "$folder"
  # shellcheck disable=SC2086  # a list of densities
  lammps ISO prepare.in -var seed "$seed" -var N "$N" -var nu_start $nu_start -var nu_max 0.82 -var nu_end $nu_end -var keep $keep
  for nu in $shear; do strain "D2-$nu" D2 "$nu" 0.26; done
  for nu in $uniaxial; do strain "UNI-$nu" UNI "$nu" 0.82; done
  for nu in $triaxial; do strain "D3-$nu" D3 "$nu" 0.26; done
  for nu in $compressed; do strain "D2-ISO-$nu" D2 "$nu" 0.15 "$(awk "BEGIN { print $nu + 0.03 }")"; done
done
