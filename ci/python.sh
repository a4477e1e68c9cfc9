# Sets $python to an interpreter that has the packages that ci/bootstrap.sh installs: the python3 in PATH, or
# Debian's own if that one is another. Sourced by the scripts beside it.
python=
for candidate in python3 /usr/bin/python3; do
  if "$candidate" -c 'import jinja2, matplotlib, numpy, pandas' >/dev/null 2>&1; then
    python=$candidate
    break
  fi
done
if [ -z "$python" ]; then
  echo "no python3 with jinja2, matplotlib, numpy and pandas was found; run ci/bootstrap.sh" >&2
  exit 1
fi
