#!/usr/bin/env bash
# check_docs.sh ROOT: fails when a page names a file that is not there, when a source names a section of docs/theory that is not
# there, or when docs/theory/index.md leaves out a parameter of the law or a column of a series that docs/formats.md lists. A name is a word of `code` or of a fenced block that begins with a
# room; a file's stem stands for its .hpp or .cpp, a pattern for at least one file. So do links to files of the tree. The
# decisions and the logs speak of their own time and are not read.
set -euo pipefail

root=${1:?usage: check_docs.sh ROOT}
rooms='model|dem|fit|predict|chain|app|python|tests|examples|docs|cmake'

violations=0
report() {
  printf '%s: %s\n' "$1" "$2"
  violations=$((violations + 1))
}

exists() { # name, possibly a pattern
  [[ -e $root/$1 || -e $root/$1.hpp || -e $root/$1.cpp ]] || compgen -G "$root/$1" >/dev/null
}

# Words of a page's code, one a line. Spans may go over the end of a line, as paragraphs do.
words_of_code() { # page
  awk '/^ *```/ { fenced = !fenced; next } fenced' "$1" | tr -s ' \t' '\n'
  awk '/^ *```/ { fenced = !fenced; next } !fenced' "$1" | tr '\n' ' ' | grep -o '`[^`]*`' | tr -d '`' | tr -s ' ' '\n' || true
}

check_names() { # page
  local word
  while IFS= read -r word; do
    word=${word%%[,;:)]*}
    exists "$word" || report "${1#"$root"/}" "names $word, which does not exist"
  done < <(words_of_code "$1" | grep -E "^($rooms)/" | sort -u)
}

check_links() { # page
  local link
  while IFS= read -r link; do
    link=${link%%#*}
    [[ -z $link || -e $(dirname "$1")/$link ]] || report "${1#"$root"/}" "links to $link, which does not exist"
  done < <(grep -oE '\]\([^)]*\)' "$1" | sed -E 's/^\]\(|\)$//g' | grep -vE '^[a-z]+:' | sort -u || true)
}

# First cells of a generated table of docs/formats.md.
keys_of() { # name of the table
  awk -v name="$1" '$0 == "<!-- begin " name " -->" { inside = 1 } $0 == "<!-- end " name " -->" { inside = 0 }
    inside' "$root/docs/formats.md" | sed -nE 's/^\| `([^`]*)` .*/\1/p'
}

check_index() {
  local key index=$root/docs/theory/index.md
  [[ -f $index && -f $root/docs/formats.md ]] || return 0
  # one component stands for all six
  while IFS= read -r key; do
    grep -qF "\`$key\`" "$index" || report docs/theory/index.md "leaves out \`$key\` of docs/formats.md"
  done < <(keys_of parameters; keys_of 'series columns' | grep -vE '_(yy|zz|yz|xz|xy)(\[|$)')
}

# Of comments like "docs/theory/fit.md, sections Covariance over packings and Degrees of freedom", over the end of a line, too.
check_sections() { # source
  local page sections section
  while IFS=: read -r page sections; do
    while IFS= read -r section; do
      [[ -f $root/$page ]] && grep -qxF "## $section" "$root/$page" ||
        report "${1#"$root"/}" "names section \"$section\" of $page, which does not exist"
    done < <(sed -E 's/, | and /\n/g' <<<"$sections")
  done < <(sed -E 's#^[^"]*//[/<]* *##; t; s/.*/./' "$1" | tr '\n' ' ' | grep -oE 'docs/theory/[a-z]+\.md, sections? [^.;:)]*' |
    sed -E 's/, sections? /:/; s/ +$//' || true)
}

pages=0
for page in "$root"/README.md "$root"/CONTRIBUTING.md "$root"/docs/*.md "$root"/docs/theory/*.md; do
  [[ -f $page && $page != *-log.md ]] || continue
  pages=$((pages + 1))
  check_names "$page"
  check_links "$page"
done
check_index
while IFS= read -r source; do
  check_sections "$source"
done < <(for room in ${rooms//|/ }; do
  [[ -d $root/$room ]] && grep -rl --include='*.[hc]pp' 'docs/theory/' "$root/$room" || true
done)

printf '%d pages, %d violations\n' "$pages" "$violations"
((pages > 0 && violations == 0))
