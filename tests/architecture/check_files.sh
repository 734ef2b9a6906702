#!/usr/bin/env bash
# check_files.sh ROOT: fails for a source file above 400 lines or with a name that says nothing, for a document that begins
# as null (model/files/json_document.hpp), and for a stream in memory that would end where memory does and say nothing of it.
set -euo pipefail

root=${1:?usage: check_files.sh ROOT}
max_lines=400
# A word of a file's or a folder's name, e.g. string_utils.cpp
empty_names='(^|[/._-])(utils?|commons?|helpers?|misc)([/._-]|$)'

violations=0
report() {
  printf '%s: %s\n' "$1" "$2"
  violations=$((violations + 1))
}

files=0
while read -r lines file; do
  if [[ $file == total ]]; then continue; fi
  files=$((files + 1))
  path=${file#"$root"/}
  if ((lines > max_lines)); then
    report "$path" "$lines lines, at most $max_lines"
  fi
  if [[ $path =~ $empty_names ]]; then
    report "$path" "name it after what it does, not '${BASH_REMATCH[2]}'"
  fi
done < <(for room in model dem fit predict chain app python tests examples; do
  if [[ -d $root/$room ]]; then
    find "$root/$room" -type f \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' -o -name '*.sh' \
      -o -name '*.cmake' -o -name 'CMakeLists.txt' -o -name '*.py' -o -name '*.js' -o -name '*.css' \
      -o -name '*.html' -o -name '*.mustache' \) -print0
  fi
done | xargs -0 -r wc -l)

while IFS=: read -r file line _; do
  report "${file#"$root"/}:$line" 'begin it as OrderedJson::object() or OrderedJson::array()'
done < <(find "$root" -mindepth 2 -name '*.[ch]pp' ! -path '*/tests/*' ! -path '*/build/*' \
  -exec grep -HnE '\bOrderedJson [a-z_]+;' {} + || true)

# A stream catches what its string throws and goes on as if nothing more came, unless it is told not to; mustache has one of its own.
while IFS=: read -r file line text; do
  if [[ $text =~ \.render\( ]]; then
    report "${file#"$root"/}:$line" 'render into a string by a function: a stream ends without a word where memory does'
  elif [[ $text =~ stringstream\ ([a-z_]+) && $(sed -n "$((line + 1))p" "$file") != *" ${BASH_REMATCH[1]}.exceptions(std::ios::badbit);"* ]]; then
    report "${file#"$root"/}:$line" "follow it by ${BASH_REMATCH[1]}.exceptions(std::ios::badbit);"
  fi
done < <(find "$root" -mindepth 2 -name '*.[ch]pp' ! -path '*/tests/*' ! -path '*/build/*' \
  -exec grep -HnE 'stringstream|\.render\([a-z_]+\)' {} + || true)

printf '%d files, %d violations\n' "$files" "$violations"
((files > 0 && violations == 0))
