#!/bin/sh
# The dialogs of the plugin for QGIS in its own window, on a screen that is not there. Usage:
# qgis_dialogs.sh FRANA SOURCE_DIR WORK_FOLDER
# Needs qgis, its Python and xvfb-run. Exits with 77 (skipped) without it, 1 when something is wrong; pictures stay in WORK_FOLDER.
set -u
skip() { echo "skipped: $*"; exit 77; }

command -v xvfb-run > /dev/null && command -v xauth > /dev/null || skip "no xvfb-run (packages xvfb and xauth)"
qgis=$(command -v qgis.bin || command -v qgis) || skip "no qgis (package qgis)"
python3 -c "import qgis.core" 2>/dev/null || /usr/bin/python3 -c "import qgis.core" 2>/dev/null ||
    skip "no Python that imports qgis (package python3-qgis)"
export FRANA_PROGRAM=$1 FRANA_SOURCE=$2 FRANA_WORK=$3
rm -rf "$FRANA_WORK"
mkdir -p "$FRANA_WORK/home/run" && chmod 700 "$FRANA_WORK/home/run" || exit 1
export HOME="$FRANA_WORK/home" XDG_RUNTIME_DIR="$FRANA_WORK/home/run" LANG=C.UTF-8
export PYTHONDONTWRITEBYTECODE=1
plugins=$HOME/.local/share/QGIS/QGIS3/profiles/default/python/plugins
mkdir -p "$plugins" && cp -r "$FRANA_SOURCE/apps/qgis/frana_qgis" "$plugins" || exit 1
timeout 500 xvfb-run -a -s "-screen 0 1400x1000x24" "$qgis" --nologo --noversioncheck --code "$FRANA_SOURCE/tests/qgis/dialogs.py" > "$FRANA_WORK/qgis.log" 2>&1
[ $? = 124 ] && { echo "the dialogs took longer than 500 s" >&2; exit 1; }
[ -f "$FRANA_WORK/said.json" ] || { tail -20 "$FRANA_WORK/qgis.log"; echo "QGIS ended before its dialogs were seen" >&2; exit 1; }
said=$(cat "$FRANA_WORK/said.json")
[ "$said" = "{}" ] || { echo "$said" >&2; exit 1; }
echo "dialogs of check, run, runcase, compare, ensemble and calibrate; a run by its button: $FRANA_WORK"
