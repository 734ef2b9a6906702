# SIGKILL at random moments of the whole chain, KILLS times (default 4): nothing half under a final name, and the same command
# then ends with the same digits and leaves nothing over. Each moment of the chain is as likely as another; one in three who go on
# is killed, too.
. "$GRAINLAW_SOURCE_DIR/tests/survival/chain_scene.bash"
kills=${KILLS:-4}
RANDOM=${SEED:-7}

killed=0 sound=0 starts=0
declare -A struck=()
while ((killed < kills)); do
  read -r step delay < <(for step in "${steps[@]}"; do echo "$step ${seconds[$step]}"; done |
    awk -v r=$((RANDOM * 32768 + RANDOM)) '{ name[NR] = $1; time[NR] = $2; all += $2 }
      END { t = all * r / 2 ^ 30; for (i = 1; t > time[i] && i < NR; ++i) t -= time[i]; print name[i], t }')
  start_of "$step"
  good=0 bad=0
  while true; do
    starts=$((starts + 1)) code=0
    # shellcheck disable=SC2086
    (cd work && exec timeout --signal KILL "$delay" "$grainlaw" ${command[$step]} --quiet) >said 2>log || code=$?
    what="kill $((killed + 1)): $step after $delay s"
    if ((code != 137)); then break; fi
    killed=$((killed + 1)) struck[$step]=$((${struck[$step]:-0} + 1))
    if check_unfinished "$step" "$what"; then good=$((good + 1)); else bad=1; fi
    ((RANDOM % 3 == 0)) || break
    delay=$(awk -v s="${seconds[$step]}" -v r="$RANDOM" 'BEGIN { print s * r / 32768 }')
  done
  ((starts <= 20 * kills + 100)) || fail "only $killed of $starts kills came in time"
  code=0
  run_step "$step" >said 2>log || code=$?
  if ((code != codes[$step])); then
    finding "$what: does not go on, exit code $code: $(cat log)"
  elif check_finished "$step" "$what, again" && ((bad == 0)); then
    sound=$((sound + good))
  fi
done
for step in "${steps[@]}"; do echo "chain_kills.$step ${struck[$step]:-0}"; done
printf '%s %s\n' chain_kills.kills "$killed" chain_kills.sound "$sound"
found_nothing
