# Completions in the shells that are here, and manual pages: made from the table of commands, written beside the program by the
# build. A shell that is not installed is left out.
set -euo pipefail
grainlaw=$1
share=$(dirname "$grainlaw")/../share
fail() { echo "FAIL: $*" >&2; exit 1; }
PATH=$(dirname "$grainlaw"):$PATH
touch here.json

for shell in bash zsh fish; do "$grainlaw" completion $shell >$shell.script; done
cmp bash.script "$share/bash-completion/completions/grainlaw" || fail "the build's script of bash is another"
cmp zsh.script "$share/zsh/site-functions/_grainlaw" || fail "the build's script of zsh is another"
cmp fish.script "$share/fish/vendor_completions.d/grainlaw.fish" || fail "the build's script of fish is another"

# words LINE: what the shell offers for the end of it, one per line
bash_words() {
  bash --norc -c '. ./bash.script; COMP_WORDS=($1); [[ $1 == *" " ]] && COMP_WORDS+=(""); COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
    _grainlaw 2>/dev/null; printf "%s\n" "${COMPREPLY[@]}"' - "$1"
}
fish_words() { HOME=$PWD fish --no-config -c 'source fish.script; complete -C $argv[1]' "$1" 2>/dev/null | cut -f1; }
# a real terminal for zsh's line editor: what it lists after a tab
zsh_words() {
  cat >setup.zsh <<ZSH
unsetopt zle_bracketed_paste 2>/dev/null
fpath=($share/zsh/site-functions \$fpath)
autoload -U compinit
compinit -u -D
LISTMAX=0 COLUMNS=200 LINES=200 PS1='@''@'
ZSH
  HOME=$PWD zsh -f -c '
    zmodload zsh/zpty
    zpty z "TERM=dumb zsh -f -i"
    zpty -w z "source ./setup.zsh"
    zpty -r z line "*@@*"  # the prompt: keys are now read by the line editor
    zpty -n -w z "$1"$'"'"'\t\t\x15print DONE\n'"'"'
    while zpty -r z line; do print -r -- "$line"; [[ $line == DONE* ]] && break; done' - "$1" | tr -d '\r\a' | tr -s ' ' '\n'
}
offers() { # SHELL LINE WORD...
  local shell=$1 line=$2
  shift 2
  "${shell}_words" "$line" >words
  for word in "$@"; do grep -qxF -- "$word" words || fail "$shell: '$line' does not offer $word: $(head -c 2000 words)"; done
}
shells=(bash)
for shell in zsh fish; do command -v $shell >/dev/null && shells+=("$shell"); done
for shell in "${shells[@]}"; do
  offers "$shell" 'grainlaw ' init check simulate calibrate predict report study
  offers "$shell" 'grainlaw study ' integrator dem fit chain bands prior
  offers "$shell" 'grainlaw calibrate --co' --coupling
  offers "$shell" 'grainlaw calibrate --coupling ' energy single
  offers "$shell" 'grainlaw predict --model ' reduced evolution memory
  offers "$shell" 'grainlaw study dem --' --reference --vary
  offers "$shell" 'grainlaw check he' here.json
  echo "completion.$shell ok"
done

# manual pages without a warning, each with what its help says
command -v man >/dev/null || exit 0
count=0
for page in "$share"/man/man1/*.1; do
  MANROFFSEQ='' LC_ALL=C.UTF-8 man --warnings -E UTF-8 -l "$page" >shown 2>warnings || fail "$page: $(cat warnings)"
  [[ ! -s warnings ]] || fail "$page: $(cat warnings)"
  grep -q 'EXIT STATUS' shown || fail "$page is not shown"
  count=$((count + 1))
done
LC_ALL=C.UTF-8 MANWIDTH=200 man -l "$share/man/man1/grainlaw-predict.1" 2>/dev/null | col -b >shown
for word in --seeds --dry-run 'reduced|evolution|memory'; do grep -q -- "$word" shown || fail "no $word in the manual"; done
echo "manual.pages $count"
