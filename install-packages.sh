#!/usr/bin/env bash
# install-packages.sh [--full]: installs those packages of debian-packages.txt that are missing, as root or through
# sudo; with --full those of debian-packages-full.txt too. Does nothing, and needs no rights, when all are there.
set -euo pipefail

here=$(dirname "${BASH_SOURCE[0]}")
lists=("$here/debian-packages.txt")
case $#:${1:-} in
  0:) ;;
  1:--full) lists+=("$here/debian-packages-full.txt") ;;
  *) sed -n 's/^# //; 2,3p' "${BASH_SOURCE[0]}" >&2; exit 2 ;;
esac

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install-packages: not a Debian system; using what is installed. Needed: see ${lists[*]}" >&2
  exit 0
fi

missing=()
while read -r package _; do
  [[ -z $package || $package == \#* ]] && continue
  # A nodejs that is not Debian's brings npm along and conflicts with Debian's.
  [[ $package == npm ]] && command -v npm >/dev/null && continue
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done < <(cat "${lists[@]}")
((${#missing[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "install-packages: neither root nor sudo. Ask an administrator for:" >&2
    echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y "$@"
}

install_missing() {
  apt install --no-install-recommends "${missing[@]}"
}

echo "install-packages: installing ${missing[*]}" >&2
# The package lists of a fresh machine are empty, those of an old one may be stale.
if ! apt-get -qq -s install --no-install-recommends "${missing[@]}" >/dev/null 2>&1; then
  apt update >&2
fi
if ! install_missing >&2; then
  apt update >&2
  install_missing >&2
fi
