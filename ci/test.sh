#!/usr/bin/env bash
# Installs what is missing, builds and runs all tests: C++ (GoogleTest through ctest), Python (pytest through ctest).
#   ci/test.sh [--sanitize] [-R REGEX]      --sanitize: the asan preset; -R: only tests whose name matches
set -euo pipefail
cd "$(dirname "$0")/.."

preset=release
filter=()
while [ $# -gt 0 ]; do
  case "$1" in
    --sanitize) preset=asan ;;
    -R) filter=(-R "${2:?-R needs a regular expression}"); shift ;;
    -h | --help) sed -n '2,3s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "test: unknown option $1; allowed: --sanitize, -R REGEX" >&2; exit 2 ;;
  esac
  shift
done

./ci/bootstrap.sh
cmake --preset "$preset"
cmake --build --preset "$preset" --parallel
if [ "$preset" = asan ]; then
  export ASAN_OPTIONS=detect_leaks=1:abort_on_error=1
  export LSAN_OPTIONS=suppressions=$PWD/ci/lsan.supp:print_suppressions=0
  export UBSAN_OPTIONS=print_stacktrace=1
fi
ctest --preset "$preset" --timeout 600 "${filter[@]}"
