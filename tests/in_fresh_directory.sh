#!/usr/bin/env bash
# Runs SCRIPT ARG... in a new temporary directory that is removed afterwards.
set -euo pipefail
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
cd "$directory"
bash "$@"
