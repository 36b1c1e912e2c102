# To be sourced by checks that look at our results with npm's programs: node finds packages in $CRSPF_NODE_MODULES, or
# NODE_PATH, and a check that lacks one says so.
export NODE_PATH=${CRSPF_NODE_MODULES:-${NODE_PATH:-}}

skip() {
    echo "skipped: $*"
    exit 77
}

# need_packages NAME...
need_packages() {
    local name
    command -v node >/dev/null || skip 'node is absent'
    for name in "$@"; do
        node -e "require('$name')" 2>/dev/null ||
            skip "the npm package $name is not in \$CRSPF_NODE_MODULES (npm install --prefix FOLDER $*)"
    done
}
