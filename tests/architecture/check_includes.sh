#!/usr/bin/env bash
# check_includes.sh ROOT: fails when an include of a room breaks include_rules.txt or when an own
# header is not included as "room/file.hpp". One line per violation: file:line: reason.
set -euo pipefail

root=${1:?usage: check_includes.sh ROOT}
rules=$(dirname "${BASH_SOURCE[0]}")/include_rules.txt

declare -A allowed=() private=() in_vocabulary=()
while IFS= read -r line; do
  line=${line%%#*}
  key=${line%%: *} value=${line#*:}
  key=${key%:}
  case $line in
    room\ *) allowed[${key#room }]=" ${key#room } $value " ;;
    vocabulary\ *) for name in $value; do in_vocabulary[$name]=1; done ;;
    private\ *) private[${key#private }]=${value// /} ;;
  esac
done <"$rules"

violations=0
report() {
  printf '%s:%s: %s\n' "${1#"$root"/}" "$2" "$3"
  violations=$((violations + 1))
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

check_angled() { # file room line header
  if [[ -f $root/$4 ]]; then
    report "$1" "$3" "own header <$4>: write it in quotes"
  fi
}

check_quoted() { # file room line header
  local target=${4%%/*} stem
  if [[ $4 != */* || -z ${allowed[$target]:-} ]]; then
    report "$1" "$3" "\"$4\" is not of the form \"room/file.hpp\""
    return
  fi
  if [[ ! -f $root/$4 ]]; then
    report "$1" "$3" "\"$4\" does not exist"
  fi
  if [[ ${allowed[$2]} != *" $target "* ]]; then
    report "$1" "$3" "$2 must not include $target (\"$4\")"
  elif [[ $target == model ]]; then
    stem=${4#model/} stem=${stem%.hpp}
    if [[ $2 == dem && -z ${in_vocabulary[$stem]:-} ]]; then
      report "$1" "$3" "dem must not know the law: \"$4\" is not in the vocabulary"
    fi
    if [[ $2 == model && -n ${in_vocabulary[$(basename "${1%.*}")]:-} && -z ${in_vocabulary[$stem]:-} ]]; then
      report "$1" "$3" "the vocabulary must not include \"$4\""
    fi
  fi
}

include='^[[:space:]]*#[[:space:]]*include[[:space:]]*(<([^>]+)>|"([^"]+)")'
files=0
while IFS= read -r -d '' file; do
  files=$((files + 1))
  path=${file#"$root"/}
  room=${path%%/*}
  while IFS=: read -r number text; do
    if [[ ! $text =~ $include ]]; then
      report "$file" "$number" "cannot read this include"
    elif check_private "$file" "$room" "$number" "${BASH_REMATCH[2]:-${BASH_REMATCH[3]}}"; then
      continue
    elif [[ -n ${BASH_REMATCH[2]} ]]; then
      check_angled "$file" "$room" "$number" "${BASH_REMATCH[2]}"
    else
      check_quoted "$file" "$room" "$number" "${BASH_REMATCH[3]}"
    fi
  done < <(grep -nE '^[[:space:]]*#[[:space:]]*include' "$file" || true)
done < <(for room in "${!allowed[@]}"; do
  if [[ -d $root/$room ]]; then
    find "$root/$room" -type f \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' \) -print0
  fi
done)

printf '%d files, %d violations\n' "$files" "$violations"
((files > 0 && violations == 0))
