#!/usr/bin/env bash
# What the core's libraries ask of the outside world, held against a short list of what they may ask. The core does not
# allocate, throw, lock, print, read a clock or call libm where its last bit is a matter of taste; if it did, the
# symbol would show here, whatever the tests cover.
set -euo pipefail

usage="usage: core_symbols.sh LIBRARY...            check static libraries or object files
       core_symbols.sh --self-test COMPILER  plant violations and demand that they are found"

# Block copies; roundings and roots, which IEEE 754 defines to the bit; the stop of a failed assertion; the processor's
# features, asked once to choose a kernel; what the linker and stack protector add; on ARM what the compiler's own library
# has where others have instructions, atomics, 64-bit quotients and conversions, and the name in its tables of frames.
allowed='^(memcpy|memmove|memset|memcmp|bcmp
|sqrtf?|floorf?|ceilf?|truncf?|roundf?|rintf?|nearbyintf?|lround|llround|lrint|llrint|fmod
|abort|__assert_fail
|__cpu_model|__cpu_indicator_init
|__aarch64_(cas|swp|ldadd|ldclr|ldeor|ldset)[1248]_(relax|acq|rel|acq_rel)
|__aeabi_(u?ldivmod|u?idiv(mod)?|[df]2u?lz|u?l2[df]|unwind_cpp_pr[01])
|_GLOBAL_OFFSET_TABLE_|__stack_chk_fail)$'
allowed=${allowed//$'\n'/}

# Prints each forbidden symbol of one library; succeeds when there is none.
check() {
    local library=$1 symbols undefined defined forbidden
    symbols=$(nm --demangle --format=posix "$library" 2>/dev/null) || {
        echo "$library: nm cannot read it" >&2
        return 1
    }
    # Posix format: NAME TYPE [VALUE SIZE]. A demangled name may hold blanks, so the type is sought from the right.
    undefined=$(sed -nE 's/^(.*) [Uw]( +0* *0*)? *$/\1/p' <<<"$symbols" | sort -u)
    defined=$(sed -nE 's/^(.*) [A-TV-Za-uvx-z]( .*)?$/\1/p' <<<"$symbols" | sort -u)
    # What one object of the library gives another is no outside world; nor is another core library, all crspf::.
    forbidden=$(comm -23 <(printf '%s\n' "$undefined") <(printf '%s\n' "$defined") |
        grep -vE "$allowed" | grep -vE '^(vtable for |guard variable for )?crspf::' | grep -v '^$' | sed "s|^|$library: the core must not use: |" || true)
    if [[ -n $forbidden ]]; then
        echo "$forbidden"
        return 1
    fi
}

self_test() {
    local compiler=$1 found symbol failed=0
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    cat >"$work/planted.cpp" <<'CPP'
#include <time.h>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <vector>
void drop(void* block) { std::free(block); }
void* more(void* block, unsigned n) { return std::realloc(block, n); }
void* make(unsigned n) { return n > 1 ? std::malloc(n) : std::calloc(n, n); }
double libm(double x) { return std::sin(x) + std::atan2(x, 2.0) + std::exp(x) + std::pow(x, 0.3); }
int grow(std::vector<int>& v) { v.push_back(1); return v.at(9); }
void lock(std::mutex& m) { m.lock(); }
void say(double x) { std::printf("%f", x); }
void fail() { throw 1; }
long now() { timespec t{}; clock_gettime(CLOCK_MONOTONIC, &t); return t.tv_sec; }
int lazy() { static int value = std::rand(); return value; }
CPP
    cat >"$work/clean.cpp" <<'CPP'
#include <cmath>
#include <cstring>
namespace crspf { double other(double); }
double root(double x) { return std::sqrt(x) + std::floor(x) + crspf::other(x); }
void copy(void* to, const void* from, unsigned long n) { std::memcpy(to, from, n); }
CPP
    "$compiler" -std=c++20 -O1 -c "$work/planted.cpp" -o "$work/planted.o"
    "$compiler" -std=c++20 -O1 -c "$work/clean.cpp" -o "$work/clean.o"
    found=$(check "$work/planted.o") && { echo "planted.o passed"; failed=1; }
    for symbol in malloc calloc realloc free 'operator new' 'operator delete' __cxa_throw __cxa_guard_acquire \
        'std::__throw' pthread_mutex_lock printf clock_gettime sin atan2 exp pow rand; do
        grep -q "must not use: .*$symbol" <<<"$found" || { echo "planted but not found: $symbol"; failed=1; }
    done
    check "$work/clean.o" || { echo "clean.o was refused"; failed=1; }
    check "$work/none.o" 2>/dev/null && { echo "a missing library passed"; failed=1; }
    return $failed
}

case ${1:-} in
    --self-test) self_test "${2:?$usage}" ;;
    '' | -*) echo "$usage" >&2; exit 2 ;;
    *)
        status=0
        for library in "$@"; do
            check "$library" || status=1
        done
        exit $status
        ;;
esac
