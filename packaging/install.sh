#!/bin/sh
# Installs the program maille from an archive of a release, without a compiler.
#
#   sh install.sh                                   from the archives beside this file, into ~/.local/bin
#   sh install.sh --from https://HOST/FOLDER        from a folder on the web, as a release has it
#   sh install.sh --into /usr/local/bin
#
# The archive is that of this system, and its SHA-256 must be the one in the folder's SHA256SUMS.
set -eu

fail() {
    echo "install.sh: $*" >&2
    exit 1
}

here=$(dirname "$0")
from=
into=${HOME:-/root}/.local/bin
while [ $# -gt 0 ]; do
    case $1 in
        --from) [ $# -gt 1 ] || fail "--from needs an address or a folder"; from=$2; shift 2 ;;
        --into) [ $# -gt 1 ] || fail "--into needs a folder"; into=$2; shift 2 ;;
        -h | --help) sed -n '2,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
        *) fail "unknown option $1; there are --from and --into" ;;
    esac
done
: "${from:=$here}"

case $(uname -s) in
    Linux) os=linux ;;
    Darwin) os=macos ;;
    *) fail "there is no archive for $(uname -s); on Windows unpack that for windows" ;;
esac
case $(uname -m) in
    x86_64 | amd64) cpu=x86_64 ;;
    aarch64 | arm64) cpu=aarch64 ;;
    *) fail "there is no archive for $(uname -m); build it with cargo instead" ;;
esac

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
trap 'exit 1' HUP INT TERM
fetch() { # NAME: brings a file of the source into the folder
    case $from in
        http://* | https://*)
            if command -v curl >/dev/null; then
                curl -fsSL "$from/$1" -o "$folder/$1"
            elif command -v wget >/dev/null; then
                wget -qO "$folder/$1" "$from/$1"
            else
                fail "needs curl or wget"
            fi ;;
        *) cp "$from/$1" "$folder/$1" ;;
    esac || fail "cannot get $1 from $from"
}

fetch SHA256SUMS
archive=$(awk -v end="-$cpu-$os.tar.gz" 'substr($2, length($2) - length(end) + 1) == end { print $2 }' "$folder/SHA256SUMS")
[ -n "$archive" ] || fail "$from has no archive for $cpu-$os"
[ "$(echo "$archive" | wc -l)" -eq 1 ] || fail "$from has several archives for $cpu-$os"
fetch "$archive"
wanted=$(awk -v name="$archive" '$2 == name { print $1 }' "$folder/SHA256SUMS")
if command -v sha256sum >/dev/null; then
    found=$(sha256sum "$folder/$archive" | cut -d' ' -f1)
else
    found=$(shasum -a 256 "$folder/$archive" | cut -d' ' -f1)
fi
[ "$found" = "$wanted" ] || fail "$archive is damaged: its SHA-256 is $found, SHA256SUMS says $wanted"

tar -xzf "$folder/$archive" -C "$folder"
mkdir -p "$into"
# Copied beside the old one and renamed, so that there is a whole program at any moment.
cp "$folder/${archive%.tar.gz}/maille" "$into/.maille.new"
chmod 755 "$into/.maille.new"
mv "$into/.maille.new" "$into/maille"
"$into/maille" --version
echo "installed as $into/maille"
case :$PATH: in
    *:"$into":*) ;;
    *) echo "$into is not in your PATH; to call the program by its name alone:"
       echo "    export PATH=\"$into:\$PATH\"" ;;
esac
