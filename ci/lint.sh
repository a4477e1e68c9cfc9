#!/usr/bin/env bash
# Checks what is written: format of C++ (clang-format 14), clang-tidy with --tidy, shell syntax, Python compiles,
# JSON parses, headers compile alone.
#   ci/lint.sh [--fix] [--tidy]     --fix: format in place
set -euo pipefail
cd "$(dirname "$0")/.."

fix=
tidy=
for option in "$@"; do
  case "$option" in
    --fix) fix=1 ;;
    --tidy) tidy=1 ;;
    *) echo "lint: unknown option $option; allowed: --fix, --tidy" >&2; exit 2 ;;
  esac
done
. ci/python.sh

failed=0
mapfile -t sources < <(git ls-files '*.cpp' '*.h')
if [ -n "$fix" ]; then
  clang-format-14 -i "${sources[@]}"
else
  clang-format-14 --dry-run --Werror "${sources[@]}" || failed=1
fi
for script in $(git ls-files '*.sh'); do bash -n "$script" || failed=1; done
git ls-files -z '*.py' | xargs -0 -r "$python" -c '
import ast, sys
for name in sys.argv[1:]:
    ast.parse(open(name, encoding="utf-8").read(), name)' || failed=1
git ls-files -z '*.json' | xargs -0 -r "$python" -c '
import json, sys
for name in sys.argv[1:]:
    try:
        json.load(open(name, encoding="utf-8"))
    except ValueError as error:
        sys.exit(f"{name}: {error}")' || failed=1

# Headers alone, with the flags of any source of the release build.
if [ -f build/release/compile_commands.json ]; then
  flags="-std=c++20 -Iharness/include -Iharness -Ibuild/release/harness/include $(pkg-config --cflags OpenEXR)"
  for header in $(git ls-files 'harness/*.h' | grep -v '/tests/'); do
    g++ $flags -fsyntax-only -include "$header" -x c++ /dev/null || { echo "$header does not compile alone"; failed=1; }
  done
fi
if [ -n "$tidy" ]; then
  git ls-files 'harness/*.cpp' 'techniques/*.cpp' | grep -v '/tests/' |
    xargs -P "$(nproc)" -n 4 clang-tidy-14 -p build/release --quiet || failed=1
fi
[ "$failed" -eq 0 ] && echo "lint: clean"
exit "$failed"
