#!/bin/sh
# Opens a made-up run in ParaView itself and compares what it finds with what was written.
# Usage: pvbatch.sh MAKE_RUN_PROGRAM WORK_FOLDER
# No screen, no X server: nothing is drawn. What it needs of ParaView: pvbatch_common.sh.
# Exits with 77 (skipped) when no usable pvbatch is found, 1 when ParaView sees something else than was
# written.
set -u
make_run=$1
work=$2
here=$(cd "$(dirname "$0")" && pwd)

. "$here/pvbatch_common.sh"

"$make_run" "$work/run" "$work/expected.json" || exit 1
run_pvbatch "$here/pvbatch_open_run.py" "$work/run" "$work/expected.json" \
    >"$work/found.json" 2>"$work/pvbatch.log"
status=$?
if [ $status -ne 0 ]; then
    echo "ParaView found something else than was written (status $status), see $work"
    sed -n '/"problems"/,$p' "$work/found.json" | head -40
    tail -20 "$work/pvbatch.log"
    exit 1
fi
echo "read back by ParaView: $(sed -n 's/.*"compared": \([0-9]*\).*/\1/p' "$work/found.json") numbers, names and units compared"
echo "ParaView found what was written"
