#!/usr/bin/env bash
# The README's table of headlines is the one that `crspf experiments` wrote.
set -euo pipefail

usage="usage: readme.sh README.md HEADLINES.md   compare
       readme.sh --self-test             plant a changed figure and demand that it is noticed"

# What stands between the markers, without empty lines at its ends.
block() {
    awk '/^<!-- end of headlines -->$/ { inside = 0; ended = 1 }
        inside { text = text $0 "\n" }
        /^<!-- headlines -->$/ { inside = 1 }
        END { if (!ended || inside) exit 1; gsub(/^\n+|\n+$/, "", text); print text }' "$1"
}

compare() {
    local quoted
    quoted=$(block "$1") || { echo "$1: no block from <!-- headlines --> to <!-- end of headlines -->"; return 1; }
    if ! diff --label "$1" --label "$2" -u <(printf '%s\n' "$quoted") <(sed -e '$a\' "$2"); then
        echo "$1: the headlines are not those of $2; copy them from there"
        return 1
    fi
}

self_test() {
    local work
    work=$(mktemp -d)
    trap "rm -rf '$work'" EXIT
    printf 'Made by `x`.\n\n| run | result |\n|---|---|\n| a | 0.12 m |\n' >"$work/headlines.md"
    { printf '# Title\n\n<!-- headlines -->\n\n'; cat "$work/headlines.md"; printf '\n<!-- end of headlines -->\nrest\n'; } \
        >"$work/README.md"
    compare "$work/README.md" "$work/headlines.md" || { echo 'FAILED: equal tables differ'; return 1; }
    sed 's/0\.12/0.11/' "$work/README.md" >"$work/changed.md"
    sed '/a | 0\.12/d' "$work/README.md" >"$work/shortened.md"
    sed '/<!-- end of/d' "$work/README.md" >"$work/unmarked.md"
    for wrong in changed shortened unmarked; do
        if compare "$work/$wrong.md" "$work/headlines.md" >/dev/null; then
            echo "FAILED: not noticed: $wrong"
            return 1
        fi
    done
    echo 'readme: 3 planted, 3 found'
}

case ${1:-} in
    --self-test) self_test ;;
    -h | --help) echo "$usage" ;;
    *)
        (($# == 2)) || { echo "$usage" >&2; exit 2; }
        compare "$1" "$2"
        ;;
esac
