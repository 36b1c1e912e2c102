# The configuration reference (docs/configuration.md, which is generated from the table of parameters) as a manual page:
# crspfd.toml(5). Knows what that file holds: headings, paragraphs, and tables of
# key, type, unit, default, range, meaning.

function escaped(text) {
    gsub(/\\/, "\\e", text)
    gsub(/-/, "\\-", text)
    gsub(/'/, "\\(aq", text)
    return text
}

# `code` is bold.
function formatted(text,    parts, count, i, out) {
    count = split(text, parts, "`")
    for (i = 1; i <= count; i++) {
        out = out (i % 2 ? escaped(parts[i]) : "\\fB" escaped(parts[i]) "\\fR")
    }
    return out
}

function trimmed(text) {
    sub(/^ +/, "", text)
    sub(/ +$/, "", text)
    return text
}

function facts(type, unit, start, range,    out) {
    out = type
    out = out (unit == "" ? "" : ", " unit)
    out = out (range == "" ? "" : ", " range)
    return out "; default " start
}

BEGIN {
    print ".TH CRSPFD.TOML 5 \"\" \"CRSPF-SLAM\" \"File formats\""
    print ".SH NAME"
    print "crspfd.toml \\- configuration of CRSPF\\-SLAM"
    print ".SH DESCRIPTION"
}
/^<!--/ || /^# / || /^\|---/ || /^\| key / { next }
/^## / {
    print ".SH \"" escaped(substr($0, 4)) "\""
    next
}
/^$/ {
    print ".PP"
    next
}
/^\|/ {
    split($0, cell, "|")
    key = trimmed(cell[2])
    gsub(/`/, "", key)
    print ".TP"
    print ".B " escaped(key)
    print formatted(trimmed(cell[7]))
    print "(" formatted(facts(trimmed(cell[3]), trimmed(cell[4]), trimmed(cell[5]), trimmed(cell[6]))) ")"
    next
}
{ print "\\&" formatted($0) }
END {
    print ".SH FILES"
    print ".TP"
    print ".I /etc/crspf/crspfd.toml"
    print "the service's configuration"
    print ".TP"
    print ".I /usr/share/crspf/examples"
    print "one commented file per kind of lidar and odometer"
    print ".SH SEE ALSO"
    print ".BR crspf (1),"
    print ".BR crspfd (8)"
}
