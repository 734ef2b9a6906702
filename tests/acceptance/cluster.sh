#!/usr/bin/env bash
# tests/acceptance/cluster.sh [--quick]: when one machine is too small, one line each: NAME VALUE BOUND ok|short; exit 0 only if none
# is short. Many runs: lists of 10^4, and a Slurm of its own on this machine (apt: slurm-wlm munge) that is troubled on its way,
# 10 minutes on two cores. Then LAMMPS behind the element tests (lammps.sh); --quick: small ones, no study of friction.
set -euo pipefail

# shellcheck source=tests/acceptance/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" "$@"
out=$out/cluster
mkdir -p "$out"
# shellcheck source=tests/acceptance/cluster_slurm.sh
. tests/acceptance/cluster_slurm.sh
# shellcheck source=tests/acceptance/lammps.sh
. tests/acceptance/lammps.sh

long_lists
slurm
lammps_figures
finish_figures
