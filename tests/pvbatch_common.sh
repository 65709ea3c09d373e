# Sourced by the tests that need ParaView: finds a usable pvbatch, or skips the test (exit code 77). Wants $work.
# Needs pvbatch with its Python modules: either packages paraview and python3-paraview, or, where python3-paraview
# cannot be installed beside libvtk9-dev's python3-vtk9, that package unpacked in a folder that FRANA_PARAVIEW_PREFIX names:
#   apt-get install -y --no-install-recommends paraview
#   mkdir -p "$FRANA_PARAVIEW_PREFIX" && cd "$FRANA_PARAVIEW_PREFIX" && apt-get download python3-paraview
#   dpkg -x python3-paraview_*.deb "$FRANA_PARAVIEW_PREFIX"

skip() {
    echo "skipped: $1"
    exit 77
}

command -v pvbatch >/dev/null || skip "no pvbatch (package paraview)"
modules=${FRANA_PARAVIEW_PREFIX:+$FRANA_PARAVIEW_PREFIX/usr/lib/python3/dist-packages}
[ -z "$modules" ] || [ -d "$modules/paraview" ] || skip "FRANA_PARAVIEW_PREFIX: no $modules/paraview"

# A pvbatch that crashed may ignore SIGTERM, hence -k.
run_pvbatch() {
    PYTHONPATH=$modules${PYTHONPATH:+:$PYTHONPATH} timeout -k 5 1200 pvbatch "$@"
}

mkdir -p "$work" || exit 1
echo "import paraview.simple; print('usable')" >"$work/probe.py"
run_pvbatch "$work/probe.py" 2>/dev/null | grep -qx usable || skip "pvbatch cannot import paraview.simple"
