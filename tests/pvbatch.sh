#!/bin/sh
# Opens a made-up run in ParaView itself and compares what it finds with what was written.
# Usage: pvbatch.sh MAKE_RUN_PROGRAM WORK_FOLDER
# Needs pvbatch with its Python modules (no screen, no X server: nothing is drawn): either packages paraview
# and python3-paraview, or, where python3-paraview cannot be installed beside libvtk9-dev's python3-vtk9, that
# package unpacked in a folder that FRANA_PARAVIEW_PREFIX names:
#   apt-get install -y --no-install-recommends paraview
#   mkdir -p "$FRANA_PARAVIEW_PREFIX" && cd "$FRANA_PARAVIEW_PREFIX" && apt-get download python3-paraview
#   dpkg -x python3-paraview_*.deb "$FRANA_PARAVIEW_PREFIX"
# Exits with 77 (skipped) when no usable pvbatch is found, 1 when ParaView sees something else than was
# written.
set -u
make_run=$1
work=$2
here=$(cd "$(dirname "$0")" && pwd)

skip() {
    echo "skipped: $1"
    exit 77
}

command -v pvbatch >/dev/null || skip "no pvbatch (package paraview)"
modules=${FRANA_PARAVIEW_PREFIX:+$FRANA_PARAVIEW_PREFIX/usr/lib/python3/dist-packages}
[ -z "$modules" ] || [ -d "$modules/paraview" ] || skip "FRANA_PARAVIEW_PREFIX: no $modules/paraview"

# A pvbatch that crashed may ignore SIGTERM, hence -k.
run_pvbatch() {
    PYTHONPATH=$modules${PYTHONPATH:+:$PYTHONPATH} timeout -k 5 300 pvbatch "$@"
}

mkdir -p "$work" || exit 1
echo "import paraview.simple; print('usable')" >"$work/probe.py"
run_pvbatch "$work/probe.py" 2>/dev/null | grep -qx usable || skip "pvbatch cannot import paraview.simple"

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
echo "ParaView found what was written"
