#!/bin/sh
# The Debian packages: made, installed, used and removed. Usage: package.sh BUILD_FOLDER WORK_FOLDER
# Installs them over this system in a layer that is thrown away, as root and where the kernel has overlays. With
# FRANA_BARE_ROOT=FOLDER, a bare Debian made by `debootstrap --variant=minbase bookworm FOLDER`, apt installs them there with all
# that they depend on; needs root and a network. Exits with 77 (skipped) without cpack and dpkg, 1 when something is wrong.
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
newest=$(dpkg-deb --fsys-tarfile "$program" | tar -xO ./usr/share/doc/frana/changelog.gz | gzip -d | head -n 1)
version=$(dpkg-deb --field "$program" Version)
case $newest in "frana ($version)"*) ;; *) fail "the changelog begins with '$newest', the package is version $version" ;; esac

# This system as a root of its own, whose changes are thrown away: dpkg holds the packages against what is installed here.
overlay=$work/overlay
cat >"$work/inside.sh" <<INSIDE
set -eu
mount -t tmpfs none "$overlay" || exit 77
mkdir "$overlay/changed" "$overlay/work" "$overlay/root"
mount -t overlay none -o "lowerdir=/,upperdir=$overlay/changed,workdir=$overlay/work" "$overlay/root" || exit 77
mount -t proc none "$overlay/root/proc" || exit 77
mkdir "$overlay/root/packages"
cp "$program" "$library" "$overlay/root/packages/"
chroot "$overlay/root" sh -eu -c '
    dpkg -i /packages/*.deb
    frana --version
    frana run /usr/share/frana/cases/maungawhau/case.toml --until 1 --out /packages/run --quiet
    for made in rasters/peak_depth.tif figures/view_peak_depth.png particles.pvd run.qgz report.md; do
        [ -s /packages/run/\$made ] || { echo "the installed program left no \$made"; exit 1; }
    done
    dpkg --purge frana libfrana-dev'
find "$overlay/changed/usr" -name '*frana*' ! -type c >"$work/left"
INSIDE
mkdir -p "$overlay"
if [ "$(id -u)" = 0 ] && unshare -m true 2>/dev/null; then
    result=0
    unshare -m sh "$work/inside.sh" >"$work/inside.log" 2>&1 || result=$?
    case $result in
        0) [ ! -s "$work/left" ] || fail "left after the removal: $(cat "$work/left")"
           grep "^frana $version" "$work/inside.log" || fail "the installed program does not say version $version" ;;
        77) skip "no overlay of file systems here; the packages were made and not installed" ;;
        *) cat "$work/inside.log"; fail "installing, running or removing failed ($result)" ;;
    esac
else
    skip "not root, or no unshare; the packages were made and not installed"
fi

[ -n "${FRANA_BARE_ROOT:-}" ] || exit 0
bare=$FRANA_BARE_ROOT
rm -rf "$bare/packages"
mkdir "$bare/packages"
cp "$program" "$library" "$bare/packages/"
[ -e "$bare/proc/self" ] || mount -t proc none "$bare/proc"  # a program finds its own folder by it
inside() { chroot "$bare" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "$@"; }
inside apt-get -q update
inside sh -c 'apt-get -q install -y --no-install-recommends /packages/frana_*.deb /packages/libfrana-dev_*.deb'
inside frana run /usr/share/frana/cases/maungawhau/case.toml --until 5 --out /packages/run --quiet
[ -s "$bare/packages/run/figures/view_peak_depth.png" ] || fail "no view was drawn in the bare root"
if [ -d "$bare/usr/lib/python3/dist-packages/frana" ]; then
    inside python3 -c "import frana; print(frana.open('/packages/run').frames[-1].grid['depth'].max())"
fi
inside apt-get -q purge -y frana libfrana-dev
left=$(find "$bare/usr" -name '*frana*' ! -path '*/__pycache__*' -print)
[ -z "$left" ] || fail "left in the bare root after the removal: $left"
