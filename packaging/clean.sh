#!/bin/sh
# Installs a release into a Debian that has nothing but Python, and runs it there.
#
#   sh packaging/clean.sh target/release-files [FOLDER]
#
# FOLDER becomes the root of that Debian; it is made by debootstrap, or used again if it is there. Needs root.
set -eu
dist=$(cd "$1" && pwd)
clean=${2:-${TMPDIR:-/tmp}/maille-clean}
if [ ! -x "$clean/usr/bin/python3" ]; then
    command -v debootstrap >/dev/null || { apt-get update && apt-get install -y --no-install-recommends debootstrap; }
    debootstrap --variant=minbase --include=python3,python3-venv,ca-certificates bookworm "$clean"
fi
rm -rf "$clean/dist" "$clean/root/try"
mkdir -p "$clean/root/try"
cp -r "$dist" "$clean/dist"
# pip gets NumPy and Matplotlib as on this machine.
cp /etc/resolv.conf "$clean/etc/resolv.conf" 2>/dev/null || true
cp /etc/ssl/certs/ca-certificates.crt "$clean/etc/ssl/certs/ca-certificates.crt"
[ ! -f /etc/pip.conf ] || cp /etc/pip.conf "$clean/etc/pip.conf"

in_clean() {
    chroot "$clean" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 MPLBACKEND=Agg sh -euc "cd /root/try; $1"
}
timed() {
    begun=$(date +%s%N)
    in_clean "$2"
    echo "-- $1: $((($(date +%s%N) - begun) / 1000000)) ms"
}

in_clean '! command -v cargo && ! command -v gcc'
timed "install the program" "sh /dist/install.sh"
timed "the README's first limit" "/root/.local/bin/maille characterize 1.1 && test -s maille-out/1.1/polar.png"
timed "verify it" "/root/.local/bin/maille verify maille-out/1.1"
timed "install the Debian package" "dpkg --install /dist/*.deb >dpkg.txt && /usr/bin/maille designs >/dev/null && dpkg --remove maille >dpkg.txt"
timed "install the wheel" 'python3 -m venv --clear /root/python && /root/python/bin/pip install --quiet "$(echo /dist/*.whl)[plot]"'
awk '/^```python/ { on = 1; next } /^```/ { on = 0 } on' "$(dirname "$0")/../README.md" > "$clean/root/try/readme.py"
test -s "$clean/root/try/readme.py"
timed "the README's Python lines" "/root/python/bin/python readme.py && test -s 1.1.png"
