#!/usr/bin/env bash
# From a fresh Debian 12 to a report: installs what is missing, builds, compares two techniques on a real head CT and
# on an embedded scene over a small grid, and leaves results/quick/report.html with tables, plots and EXR frames.
set -euo pipefail
cd "$(dirname "$0")/.."

case "${1:-}" in
  '') ;;
  -h | --help) sed -n '2,3s/^# \{0,1\}//p' "$0"; exit 0 ;;
  *) echo "quickstart: unknown option $1; it takes none" >&2; exit 2 ;;
esac

./ci/bootstrap.sh
cmake --preset release -DVOLMARK_TESTS=OFF
cmake --build --preset release --parallel
. ci/python.sh
"$python" scenes/fetch.py cranium_ct
build/release/volmark run configs/quick/quick.json --results results
PYTHONPATH=analysis "$python" -m volmark_analysis report results/quick
echo "Open results/quick/report.html in a browser."
