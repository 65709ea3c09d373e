#!/bin/sh
# Runs a small case that has everything, and looks at its states in ParaView: as the run left them, after the folder was
# moved, and the templates; and at the run with the plugin. Usage: pvbatch_states.sh FRANA SOURCE_DIR WORK_FOLDER
# Needs pvbatch (see pvbatch_common.sh) and a display or Xvfb (package xvfb), for the pictures. Exits with 77 (skipped)
# when one of them is missing, 1 when something is wrong; pictures lie in WORK_FOLDER/pictures.
set -u
frana=$1
source=$2
work=$3
. "$source/tests/pvbatch_common.sh"

# An X server of our own: xvfb-run may take a number that another one holds.
if [ -z "${DISPLAY:-}" ]; then
    command -v Xvfb >/dev/null || skip "no display and no Xvfb (package xvfb)"
    rm -f "$work/display"
    Xvfb -displayfd 3 -screen 0 1600x1200x24 -nolisten tcp -noreset 3>"$work/display" 2>/dev/null &
    server=$!
    trap 'kill $server' EXIT
    for _ in 1 2 3 4 5 6 7 8 9 10; do grep -qs . "$work/display" || sleep 1; done
    [ -s "$work/display" ] || skip "Xvfb does not start"
    export DISPLAY=":$(cat "$work/display")"
fi

rm -rf "$work/run" "$work/impact" "$work/structure" "$work/phases" "$work/ensemble" "$work/elsewhere"
for name in case impact structure phases; do
    folder=$([ $name = case ] && echo run || echo $name)
    "$frana" run "$source/tests/states_case/$name.toml" --out "$work/$folder" --threads 1 --overwrite --quiet || exit 1
done
"$frana" ensemble "$source/tests/states_case/ensemble.toml" --out "$work/ensemble" --threads 1 --quiet || exit 1

# Moved: once as it is, and once with its states written again.
moved="$work/elsewhere/a run & more"
again="$work/elsewhere/again"
mkdir -p "$work/elsewhere" && cp -r "$work/run" "$moved" && cp -r "$work/run" "$again" || exit 1
"$frana" states "$again" >/dev/null || exit 1

for _ in 1 2 3; do  # a loaded machine may refuse the connection to its X server
    run_pvbatch "$source/tests/pvbatch_states.py" "$source/pvstates" "$work/pictures" "drawn::$work/run" \
        "full:impact:$work/impact" "full:structure:$work/structure" "full:phases:$work/phases" \
        "full:probability:$work/ensemble" "searched::$moved" "plain::$again" \
        "plugin::$work/run" "plugin:impact:$work/impact" >"$work/states.out" 2>"$work/states.log"
    status=$?
    grep -q "bad X server connection" "$work/states.log" || break
done
cat "$work/states.out"
grep -m 5 "ERR|" "$work/states.log" && status=1
[ $status -eq 0 ] || { echo "wrong (status $status), see $work"; tail -20 "$work/states.log"; exit 1; }

# The templates are made as pvstates/README.md says.
while read -r folder states; do
    # shellcheck disable=SC2086  # none or one
    run_pvbatch "$source/pvstates/make_states.py" "$work/$folder" $states --out "$work/made" </dev/null >"$work/made.log" 2>&1 ||
        { echo "no template from $folder:"; tail -20 "$work/made.log"; exit 1; }
done <<END
run
impact impact
structure structure
phases phases
ensemble probability
END
for state in "$source"/pvstates/*.pvsm; do
    [ -s "$work/made/${state##*/}" ] || { echo "make_states.py did not make ${state##*/}"; exit 1; }
done

# A state that the run has no files for: one sentence, exit code 2.
rm "$again/survey_areas.vtp"
"$frana" states "$again" >/dev/null || exit 1
said=$(run_pvbatch "$source/pvstates/open_run.py" "$again" --state survey 2>&1 >/dev/null)
status=$?
[ $status -eq 2 ] || { echo "exit code $status of a state that is not there; expected 2"; exit 1; }
echo "$said" | grep -q 'no state "survey": the run was not held against a survey' || { echo "said: $said"; exit 1; }

# What an older version left out of a look, and a size that is none: likewise.
sed -i 's/"profile": /"older": /' "$again/states/look.json"
said=$(run_pvbatch "$source/pvstates/open_run.py" "$again" --state profiles 2>&1 >/dev/null)
echo "$said" | grep -q 'look.json: was written by an older frana (it has no profile); run: frana states' ||
    { echo "said: $said"; exit 1; }
said=$(run_pvbatch "$source/pvstates/open_run.py" "$again" --size 1600 2>&1 >/dev/null)
echo "$said" | grep -q 'found 1600; expected WxH' || { echo "said: $said"; exit 1; }
echo "states load and show what the Python states show"
