#!/bin/sh
# A browser opens the page of a run, and what the page computes from its own data is held against the run's tables.
# Usage: web_page.sh FRANA SOURCE_DIR WORK_FOLDER. Exits with 77 (skipped) without chromium or python3.
set -u
frana=$1
source=$2
work=$3
skip() {
    echo "skipped: $1"
    exit 77
}
browser=
for name in chromium-headless-shell chromium; do
    [ -n "$browser" ] || browser=$(command -v $name)
done
[ -n "$browser" ] || skip "no chromium (package chromium)"
command -v python3 >/dev/null || skip "no python3"
rm -rf "$work"
mkdir -p "$work/home"
data=$source/cases/maungawhau
sed -e "s|\"dem.asc\"|\"$data/dem.asc\"|" -e "s|\"release.geojson\"|\"$data/release.geojson\"|" "$data/case.toml" >"$work/case.toml"
printf '[[gauge]]\nname = "rim"\npoint = [345, 410]\n' >>"$work/case.toml"
"$frana" run "$work/case.toml" --out "$work/run" --quiet --until 12 --set grid.cell=10 \
    --set 'output.formats=["web"]' >"$work/run.log" 2>&1 || {
    grep -q libjs-three "$work/run.log" && skip "this build has no three.js (package libjs-three)"
    cat "$work/run.log"
    exit 1
}
# The picture is taken once the page's time, which waits for its work, has come so far.
HOME=$work/home timeout -k 5 300 "$browser" --headless --no-sandbox --disable-dev-shm-usage --use-gl=angle \
    --use-angle=swiftshader --enable-unsafe-swiftshader --virtual-time-budget=30000 --dump-dom \
    "file://$work/run/figures/view.html#check" >"$work/dom.html" 2>"$work/browser.log" || {
    tail -5 "$work/browser.log"
    exit 1
}
python3 "$source/tests/web_page.py" "$work/dom.html" "$work/run"
