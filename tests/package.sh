#!/bin/sh
# The Debian packages: made, installed, used and removed. Usage: package.sh BUILD_FOLDER WORK_FOLDER
# Installs them into an empty root, where the program uses the libraries of this system. With FRANA_BARE_ROOT=FOLDER, a bare
# Debian made by `debootstrap --variant=minbase bookworm FOLDER`, apt installs them there with all that they depend on; needs
# root and a network. Exits with 77 (skipped) without cpack and dpkg, 1 when something is wrong.
set -eu
build=$1
work=$2

skip() { echo "skipped: $*"; exit 77; }
fail() { echo "package: $*" >&2; exit 1; }
for tool in cpack dpkg dpkg-deb dpkg-shlibdeps; do
    command -v $tool >/dev/null || skip "no $tool (packages cmake and dpkg-dev)"
done

rm -rf "$work"
mkdir -p "$work/made"
(cd "$build" && cpack -G DEB -B "$work/made" >"$work/cpack.log" 2>&1) || { cat "$work/cpack.log"; fail "cpack failed"; }
program=$(ls "$work"/made/frana_*.deb)
library=$(ls "$work"/made/libfrana-dev_*.deb)
ls -l "$program" "$library"

# What it is linked with is found by itself; what it opens at run time was named.
depends=$(dpkg-deb --field "$program" Depends)
for needed in libgdal libvtk9 libhdf5 libcairo2 libegl1 fonts-dejavu-core; do
    case $depends in *$needed*) ;; *) fail "the package does not depend on $needed: $depends" ;; esac
done
zcat_doc=$(dpkg-deb --fsys-tarfile "$program" | tar -xO ./usr/share/doc/frana/changelog.gz | gzip -d | head -n 1)
version=$(dpkg-deb --field "$program" Version)
case $zcat_doc in "frana ($version)"*) ;; *) fail "the changelog begins with '$zcat_doc', the package is version $version" ;; esac

# An empty root: nothing may be left of it after its removal.
root=$work/root
mkdir -p "$root/var/lib/dpkg/info" "$root/var/lib/dpkg/updates" "$root/var/lib/dpkg/triggers"
: >"$root/var/lib/dpkg/status"
into() { dpkg --root="$root" --log=/dev/null --force-not-root --force-depends "$@" >"$work/dpkg.log" 2>&1; }
into -i "$program" "$library" || { cat "$work/dpkg.log"; fail "installing into an empty root failed"; }
"$root/usr/bin/frana" --version | grep -q "frana $version" || fail "the installed program does not say version $version"
"$root/usr/bin/frana" run "$root/usr/share/frana/cases/maungawhau/case.toml" --until 1 --out "$work/run" --quiet
for made in rasters/peak_depth.tif figures/map_peak_depth.png run.qgz report.md; do
    [ -s "$work/run/$made" ] || fail "the installed program left no $made"
done
into --purge frana libfrana-dev || { cat "$work/dpkg.log"; fail "the removal failed"; }
left=$(find "$root" -path "$root/var/lib/dpkg" -prune -o ! -type d -print)
[ -z "$left" ] || fail "left after the removal: $left"

[ -n "${FRANA_BARE_ROOT:-}" ] || exit 0
bare=$FRANA_BARE_ROOT
cp "$program" "$library" "$bare/tmp/"
inside() { chroot "$bare" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "$@"; }
inside apt-get -q update
inside sh -c 'apt-get -q install -y --no-install-recommends /tmp/frana_*.deb /tmp/libfrana-dev_*.deb'
inside frana run /usr/share/frana/cases/maungawhau/case.toml --until 5 --out /tmp/run --quiet
[ -s "$bare/tmp/run/figures/view_peak_depth.png" ] || fail "no view was drawn in the bare root"
if [ -d "$bare/usr/lib/python3/dist-packages/frana" ]; then
    inside python3 -c "import frana; print(frana.open('/tmp/run').frames[-1].grid['depth'].max())"
fi
inside apt-get -q purge -y frana libfrana-dev
left=$(find "$bare/usr" -name '*frana*' ! -path '*/__pycache__*' -print)
[ -z "$left" ] || fail "left in the bare root after the removal: $left"
