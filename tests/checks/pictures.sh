#!/usr/bin/env bash
# The pictures that documents show are there and small, and the commands that make those of docs/how-it-works.md work.
# usage: pictures.sh REPOSITORY           each picture that a document names
#        pictures.sh REPOSITORY CRSPF     makes them by docs/pictures/make.sh, of shorter runs
#        pictures.sh --self-test
set -euo pipefail
picture_max=100000   # bytes
pictures_max=409600  # of docs/pictures

# named FOLDER: DOCUMENT PICTURE, a line each.
named() (
    cd "$1"
    find . -name '*.md' -not -path './build/*' -not -path './out/*' -exec grep -oHE '!\[[^]]*\]\([^)]+\)' {} + |
        sed -E 's/^\.\/([^:]*):.*\(([^)]+)\)$/\1 \2/'
)

# faults FOLDER: a line each.
faults() {
    local names document picture file size all=0
    names=$(named "$1" || true)
    [[ $names ]] || { echo 'no document shows a picture'; return; }
    while read -r document picture; do
        file=$1/$(dirname "$document")/$picture
        if [[ ! -s $file ]]; then
            echo "$document: $picture is absent; docs/pictures/make.sh or the command below it makes it"
        elif size=$(stat -c %s "$file"); ((size > picture_max)); then
            echo "$document: $picture has $size bytes, more than $picture_max"
        fi
    done <<<"$names"
    for file in "$1"/docs/pictures/*.{svg,png}; do
        [[ -e $file ]] || continue
        all=$((all + $(stat -c %s "$file")))
        grep -q "/$(basename "$file")$" <<<"$names" || echo "docs/pictures/$(basename "$file"): no document shows it"
    done
    ((all <= pictures_max)) || echo "docs/pictures: $all bytes, more than $pictures_max"
}

if [[ $1 == --self-test ]]; then
    folder=$(mktemp -d)
    trap 'rm -r "$folder"' EXIT
    mkdir -p "$folder/docs/pictures"
    # expect WORDS: they are among the faults; without: there are none.
    expect() {
        local found
        found=$(faults "$folder")
        if [[ ${1:-} ]]; then grep -q "$1" <<<"$found"; else [[ -z $found ]]; fi || { echo "not seen: ${1:-no fault}: $found" >&2; exit 1; }
    }
    expect 'no document shows a picture'
    printf 'See\n![a b](pictures/a.svg)\nand | ![c](pictures/b.png) |\n' >"$folder/docs/x.md"
    expect 'pictures/a.svg is absent'
    echo '<svg/>' | tee "$folder/docs/pictures/b.png" >"$folder/docs/pictures/a.svg"
    expect
    head -c $((picture_max + 1)) /dev/zero >"$folder/docs/pictures/b.png"
    expect 'b.png has'
    for i in 1 2 3 4 5; do
        head -c $((picture_max - 1)) /dev/zero >"$folder/docs/pictures/$i.png"
    done
    expect 'docs/pictures: 600003 bytes'
    expect '5.png: no document shows it'
    exit 0
fi

repository=$(realpath "$1")
if [[ $# == 1 ]]; then
    found=$(faults "$repository")
    [[ -z $found ]] || { echo "$found" >&2; exit 1; }
    exit 0
fi

folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$repository/docs/pictures/make.sh" "$2" "$folder" --short | tee "$folder/said"
made=0 skipped=
! grep '^skipped' "$folder/said" || skipped=1
while read -r document picture; do
    name=${picture#pictures/}
    case $name in
        "$picture" | match-*) continue ;;  # of another folder; not made in short
        view-*) [[ -z $skipped ]] || continue ;;
    esac
    head -c 8 "$folder/$name" | grep -aq '<svg\|PNG' || { echo "$document: docs/pictures/make.sh made no $name" >&2; exit 1; }
    ((++made))
done < <(named "$repository")
((made > 0)) || { echo 'docs/pictures/make.sh made nothing that a document shows' >&2; exit 1; }
