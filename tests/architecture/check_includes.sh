#!/usr/bin/env bash
# check_includes.sh ROOT: fails when an include of a room breaks include_rules.txt or when an own
# header is not included as "room/.../file.hpp". One line per violation: file:line: reason.
set -euo pipefail

root=${1:?usage: check_includes.sh ROOT}
rules=$(dirname "${BASH_SOURCE[0]}")/include_rules.txt

declare -A allowed=() private=() rooms=()
while IFS= read -r line; do
  line=${line%%#*}
  key=${line%%:*} value=${line#*:}
  case $line in
    private\ *) private[${key#private }]=${value// /} ;;
    *:*) allowed[$key]=" $key $value " rooms[${key%%/*}]=1 ;;
  esac
done <"$rules"

violations=0
report() {
  printf '%s:%s: %s\n' "${1#"$root"/}" "$2" "$3"
  violations=$((violations + 1))
}

# The longest folder of the rules that the path begins with, in $folder; empty when there is none.
folder_of() { # path
  folder=${1%/*}
  while [[ -z ${allowed[$folder]:-} ]]; do
    if [[ $folder != */* ]]; then
      folder=
      return
    fi
    folder=${folder%/*}
  done
}

# Is the header one that belongs to a single room? Then who includes it decides.
check_private() { # file room line header
  local prefix
  for prefix in "${!private[@]}"; do
    if [[ $4 == "$prefix"* ]]; then
      [[ $2 == "${private[$prefix]}" && ($1 == *.cpp || $1 == *-inl.hpp) ]] ||
        report "$1" "$3" "<$4> belongs to ${private[$prefix]}/*.cpp only"
      return 0
    fi
  done
  return 1
}

check_angled() { # file line header
  if [[ -f $root/$3 ]]; then
    report "$1" "$2" "own header <$3>: write it in quotes"
  fi
}

check_quoted() { # file folder line header
  if [[ $4 != */* || $4 == ../* || -z ${rooms[${4%%/*}]:-} ]]; then
    report "$1" "$3" "\"$4\" is not of the form \"room/file.hpp\""
    return
  fi
  if [[ ! -f $root/$4 ]]; then
    report "$1" "$3" "\"$4\" does not exist"
  fi
  folder_of "$4"
  if [[ ${allowed[$2]} != *" $folder "* ]]; then
    report "$1" "$3" "$2 must not include ${folder:-${4%/*}} (\"$4\")"
  fi
}

include='^[[:space:]]*#[[:space:]]*include[[:space:]]*(<([^>]+)>|"([^"]+)")'
check_include() { # file line text
  local path=${1#"$root"/}
  folder_of "$path"
  if [[ -z $folder ]]; then return; fi  # said of the file
  if [[ ! $3 =~ $include ]]; then
    report "$1" "$2" "cannot read this include"
  elif check_private "$1" "${path%%/*}" "$2" "${BASH_REMATCH[2]:-${BASH_REMATCH[3]}}"; then
    return
  elif [[ -n ${BASH_REMATCH[2]} ]]; then
    check_angled "$1" "$2" "${BASH_REMATCH[2]}"
  else
    check_quoted "$1" "$folder" "$2" "${BASH_REMATCH[3]}"
  fi
}

mapfile -d '' files < <(for room in "${!rooms[@]}"; do
  if [[ -d $root/$room ]]; then
    find "$root/$room" -type f \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' \) -print0
  fi
done)
for file in "${files[@]}"; do
  path=${file#"$root"/}
  folder_of "$path"
  if [[ -z $folder ]]; then report "$file" 1 "no line of include_rules.txt is for ${path%/*}"; fi
done
# one process for all files
if ((${#files[@]} > 0)); then
  while IFS= read -r -d '' file && IFS=: read -r number text; do
    check_include "$file" "$number" "$text"
  done < <(printf '%s\0' "${files[@]}" | xargs -0 grep -HnZE '^[[:space:]]*#[[:space:]]*include' || true)
fi

printf '%d files, %d violations\n' ${#files[@]} "$violations"
((${#files[@]} > 0 && violations == 0))
