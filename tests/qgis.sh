#!/bin/sh
# The plugin for QGIS in QGIS itself, without a screen, in a home folder of its own. Usage: qgis.sh FRANA SOURCE_DIR WORK_FOLDER
# Needs qgis_process and the Python of QGIS (packages qgis and python3-qgis). Exits with 77 (skipped) without them, 1 when
# something is wrong.
set -u
frana=$1
source=$2
work=$3

skip() { echo "skipped: $*"; exit 77; }

# Debian's qgis_process is a script that calls the program with an option which this does not know.
process=$(command -v qgis_process.bin || command -v qgis_process) || skip "no qgis_process (package qgis)"
rm -rf "$work"
mkdir -p "$work/home/run" && chmod 700 "$work/home/run" || exit 1
export HOME="$work/home" XDG_RUNTIME_DIR="$work/home/run" QT_QPA_PLATFORM=offscreen LANG=C.UTF-8 PYTHONDONTWRITEBYTECODE=1
for python in python3 /usr/bin/python3; do
    "$python" -c "import qgis.core, osgeo.gdal" 2>/dev/null && break
    python=
done
[ -n "$python" ] || skip "no Python that imports qgis (package python3-qgis)"
exec "$python" "$source/tests/qgis/in_qgis.py" "$frana" "$source" "$work" "$process"
