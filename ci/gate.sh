#!/usr/bin/env bash
# Judges whether the working tree got slower or wrong: builds it, builds the base once, measures both in turns.
#   ci/gate.sh [--base REV|DIR|FILE.json] [any option of `python3 -m volmark_analysis gate`, see its --help]
# Without --base: where this branch left origin/main; on main itself the last commit, or the one before if nothing has
# changed since.
# Exit codes: 0 same or improved, 1 regressed, 2 bad input, 3 this machine lacks something, 4 inconclusive.
set -euo pipefail
cd "$(dirname "$0")/.."

hasBase=
hasCandidate=
for option in "$@"; do
  case "$option" in
    -h | --help) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --base | --base=* | --judge | --judge=* | --store-baseline | --store-baseline=* | calibrate | history) hasBase=1 ;;
  esac
  case "$option" in
    --candidate | --candidate=* | --judge | --judge=* | history) hasCandidate=1 ;;
  esac
done

./ci/bootstrap.sh >&2 || exit 3
. ci/python.sh
if [ -z "$hasCandidate" ]; then
  configure=()
  [ -f build/release/CMakeCache.txt ] || configure=(-DVOLMARK_TESTS=OFF)
  if ! { cmake --preset release "${configure[@]}" && cmake --build --preset release --parallel; } >&2; then
    echo "gate: the working tree does not build" >&2
    exit 2
  fi
fi
base=()
if [ -z "$hasBase" ]; then
  commit=$(git merge-base HEAD origin/main 2>/dev/null || true)
  head=$(git rev-parse HEAD)
  if [ -z "$commit" ] || [ "$commit" = "$head" ]; then
    commit=$head
    if git diff --quiet HEAD --; then
      commit=$(git rev-parse --verify --quiet HEAD~1) || { echo "gate: no earlier commit; name one with --base" >&2; exit 2; }
    fi
  fi
  base=(--base "$commit")
fi
PYTHONPATH=analysis exec "$python" -m volmark_analysis gate "${base[@]}" "$@"
