#!/bin/sh
# catalyst.sh FRANA SOURCE_DIR OUT: a ParaView script inside the run sees what the run's own reduction sees.
# Exit code 77 (skipped) without ParaView's Python modules (FRANA_PARAVIEW_PREFIX or PYTHONPATH names them).
set -eu
frana=$1 source=$2 out=$3
modules=${FRANA_PARAVIEW_PREFIX:-/nowhere}/usr/lib/python3/dist-packages
PYTHONPATH=$modules${PYTHONPATH:+:$PYTHONPATH}
export PYTHONPATH
python3 -c 'import importlib.util, sys; sys.exit(importlib.util.find_spec("paraview") is None)' || exit 77

rm -rf "$out"
mkdir -p "$out"
cat > "$out/case.toml" <<END
[terrain]
dem = "$source/cases/maungawhau/dem.asc"
[[release]]
outline = "$source/cases/maungawhau/release.geojson"
depth = 4.0
[material.bed]
law = "voellmy"
mu = 0.10
xi = 300.0
[time]
end = 3.0
[output]
formats = []
[[insitu]]
name = "script"
kind = "catalyst"
script = "$source/tests/catalyst_largest.py"
[[insitu]]
name = "own"
kind = "reduce"
fields = ["depth"]
END
FRANA_CATALYST_NOTES=$out/notes.txt
export FRANA_CATALYST_NOTES
"$frana" run "$out/case.toml" --out "$out/run" --threads 1 --overwrite --quiet

# column 5 of the reduction is depth_max; the grid that ParaView gets is in single precision (6e-8 relative)
tail -n +2 "$out/run/insitu/own.csv" | cut -d, -f1,5 | tr ',' ' ' | paste -d' ' - "$out/notes.txt" | awk '
    { difference = $2 - $4; if (difference < 0) difference = -difference
      if ($1 != $3 || difference > 1e-7 * $2 || $5 < 1 || NF != 5) { print "line " NR ": " $0; bad = 1 } }
    END { if (NR != 4) { print NR " lines, not 4"; bad = 1 }; exit bad }'
