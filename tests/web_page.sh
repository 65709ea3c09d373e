#!/bin/sh
# A browser opens pages of runs and of an ensemble. What they compute from their own data is held against what the runs left.
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

# look NAME PAGE [OPTIONS]: PAGE's own numbers, and what the probe finds, go to NAME.dom. The page is read once its time, which
# waits for its work, has come so far.
look() {
    name=$1
    { sed '/^<\/body>/,$d' "$2" && echo '<script>' && cat "$source/tests/web_page_probe.js" && echo '</script></body></html>'; } \
        >"$work/$name.html"
    shift 2
    HOME=$work/home timeout -k 5 300 "$browser" --headless --no-sandbox --disable-dev-shm-usage --use-gl=angle \
        --use-angle=swiftshader --enable-unsafe-swiftshader --virtual-time-budget=30000 "$@" --dump-dom \
        "file://$work/$name.html#check" >"$work/$name.dom" 2>"$work/browser.log" || {
        tail -5 "$work/browser.log"
        exit 1
    }
}

data=$source/cases/maungawhau
sed -e "s|\"dem.asc\"|\"$data/dem.asc\"|" -e "s|\"release.geojson\"|\"$data/release.geojson\"|" "$data/case.toml" >"$work/case.toml"
printf '[[gauge]]\nname = "rim"\npoint = [345, 410]\n' >>"$work/case.toml"
run() {
    "$frana" run "$work/case.toml" --quiet --set grid.cell=10 --set 'output.formats=["web"]' "$@" >"$work/run.log" 2>&1 || {
        grep -q libjs-three "$work/run.log" && skip "this build has no three.js (package libjs-three)"
        cat "$work/run.log"
        exit 1
    }
}
run --out "$work/run" --until 12
run --out "$work/thin" --until 2 --set release.0.depth=0.05
look run "$work/run/figures/view.html"
look flat "$work/run/figures/view.html" --disable-3d-apis
look thin "$work/thin/figures/view.html"

sed -e "s|\"../maungawhau/|\"$data/|" -e 's/^cell = .*/cell = 10.0/' -e 's/^end = .*/end = 20.0/' "$source/cases/ensemble/case.toml" \
    >"$work/many.toml"
sed -e 's/"case.toml"/"many.toml"/' -e 's/^samples = .*/samples = 32/' "$source/cases/ensemble/ensemble.toml" >"$work/ensemble.toml"
{ "$frana" ensemble "$work/ensemble.toml" --out "$work/many" --quiet &&
    "$frana" ensemble --join "$work/many" --exceed peak_depth=1 --exceed peak_speed=5 --quiet; } >"$work/many.log" 2>&1 || {
    cat "$work/many.log"
    exit 1
}
look many "$work/many/figures/view.html"
python3 "$source/tests/web_page.py" "$work"
