#!/usr/bin/env bash
# The report of `crspf experiments` in a browser without a network: pictures and charts are seen, nothing is fetched.
set -euo pipefail

usage="usage: report.sh SAMPLE_REPORT | --report FILE.html
  SAMPLE_REPORT  the program of tests/checks/sample_report.cpp; its report is looked at, and is damaged to see it noticed
  --report       only looks at a report that there is
Says 'skipped: ' and leaves with 77 where there is no chromium. Exit status 1 if something is wrong."
if (($# == 0)) || [[ $1 == --report && $# != 2 || $1 != --report && $# != 1 ]]; then
    echo "$usage" >&2
    exit 2
fi
if ! command -v chromium >/dev/null; then
    echo 'skipped: chromium is not installed'
    exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The report has no script; the copy that is looked at gets one that writes its verdict into the page.
read -r -d '' judge <<'JS' || true
<script>
addEventListener("load", async () => {
    const wrong = [];
    const all = selector => [...document.querySelectorAll(selector)];
    for (const image of all("img")) {
        await image.decode().catch(() => {});
        if (!(image.naturalWidth > 0)) wrong.push("a picture is not decoded: " + image.alt);
    }
    for (const svg of all("svg")) {
        const box = svg.getBoundingClientRect();
        if (!(box.width > 100 && box.height > 100)) wrong.push("a chart has no size");
        if (svg.querySelectorAll("path").length === 0) wrong.push("a chart is empty");
    }
    if (all("table.claims").length === 0) wrong.push("there is no table of claims");
    for (const link of all("a[href]")) {
        const to = link.getAttribute("href");
        if (!to.startsWith("#") || !document.getElementById(to.slice(1))) wrong.push("a link leads nowhere: " + to);
    }
    for (const element of all("[src], link[href], image, use, iframe, object, embed, script[src]")) {
        const from = element.getAttribute("src") ?? element.getAttribute("href") ?? "";
        if (!from.startsWith("data:")) wrong.push("from outside: " + (from || element.tagName));
    }
    for (const entry of performance.getEntriesByType("resource")) {
        if (!entry.name.startsWith("data:")) wrong.push("fetched: " + entry.name);
    }
    if (all("script").length !== 1) wrong.push("it has a script");
    if (document.documentElement.scrollWidth > innerWidth) wrong.push("it is wider than the window");
    const verdict = document.createElement("pre");
    verdict.textContent = "verdict: " + (wrong.join("; ") || "right") +
        ` (${all("img").length} pictures, ${all("svg").length} charts, ${innerWidth} px)`;
    document.body.append(verdict);
});
</script>
JS

# look FILE WIDTH: what is wrong with it, or nothing
look() {
    local page=$work/page.html said
    { cat "$1"; printf '%s\n' "$judge"; } >"$page"
    rm -rf "$work/profile"
    said=$(timeout 120 chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
        --disable-background-networking --disable-component-update --disable-sync --disable-dev-shm-usage \
        --user-data-dir="$work/profile" --window-size="$2,900" --virtual-time-budget=5000 --dump-dom "file://$page" \
        2>"$work/chromium.log" | grep -o '<pre>verdict: [^<]*') || { tail -n 5 "$work/chromium.log"; said='<pre>verdict: none'; }
    said=${said#<pre>}
    echo "$said"
    [[ $said == 'verdict: right '* ]]
}

if [[ $1 == --report ]]; then
    look "$2" 1000
    exit
fi

"$1" "$work/report.html"
for width in 1000 500; do  # a desk's window and the narrowest that headless Chromium has
    look "$work/report.html" "$width" || { echo 'FAILED: see the verdict'; exit 1; }
done

# Positive controls: each damage must be noticed.
# damaged NAME SED_SCRIPT
damaged() {
    sed "$2" "$work/report.html" >"$work/damaged.html"
    ! cmp -s "$work/report.html" "$work/damaged.html" || { echo "FAILED: nothing to damage: $1"; exit 1; }
    if look "$work/damaged.html" 1000; then
        echo "FAILED: not noticed: $1"
        exit 1
    fi
}
damaged 'a broken picture' 's|data:image/png;base64,|&AAAA|'
damaged 'a picture from outside' 's|<main>|&<img alt="x" src="http://127.0.0.1:9/x.png">|'
damaged 'a style from outside' 's|</head>|<link rel="stylesheet" href="file:///dev/null">&|'
damaged 'a chart without a size' 's|</head>|<style>svg{display:none!important}</style>&|'
damaged 'a link that leads nowhere' 's|id="absent"|id="abscent"|'
