#!/usr/bin/env bash
# Installs what volmark needs on Debian 12: compilers, libraries, Python packages, and lavapipe
# (Mesa's Vulkan on the CPU) from bookworm-backports, because bookworm's own Mesa lacks mesh shaders.
# Idempotent: installs only what is missing and says what it does.
set -euo pipefail

usage() {
  cat <<'TXT'
usage: ci/bootstrap.sh [--check] [--help]

  --check   only list what is missing; exit 0 if nothing is, 1 otherwise
  --help    this text

Needs root or sudo to install. Works on Debian 12 (bookworm), amd64 or arm64.
TXT
}

packages=(
  # build
  build-essential ca-certificates clang-14 clang-format-14 clang-tidy-14 cmake git ninja-build pkg-config
  # libraries
  glslang-dev glslang-tools libbenchmark-dev libcli11-dev libfmt-dev libglm-dev libgtest-dev libgmock-dev libimath-dev
  libinsighttoolkit5-dev libmeshoptimizer-dev libopenexr-dev libopenvdb-dev libvulkan-dev libxxhash-dev
  nlohmann-json3-dev spirv-tools vulkan-validationlayers zlib1g-dev
  # analysis and tests
  chromium libbenchmark-tools openexr python3 python3-distributed python3-jinja2 python3-jsonschema python3-matplotlib
  python3-numpy python3-pandas python3-pytest python3-scipy python3-skimage valgrind
  # data: a real head CT, a real head MRI, closed meshes
  invesalius-examples mricron-data libcgal-demo
)
# Held to the backports suite; everything else comes from bookworm itself.
backports=(mesa-vulkan-drivers)
minimum_mesa=24

isInstalled() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

mesaMajor() { dpkg-query -W -f='${Version}' mesa-vulkan-drivers 2>/dev/null | sed -E 's/^([0-9]+:)?([0-9]+).*/\2/'; }

mesaIsRecent() {
  isInstalled mesa-vulkan-drivers || return 1
  local major
  major=$(mesaMajor)
  [ "${major:-0}" -ge "$minimum_mesa" ]
}

listMissing() {
  local name
  for name in "${packages[@]}"; do isInstalled "$name" || echo "$name"; done
  mesaIsRecent || echo "mesa-vulkan-drivers>=$minimum_mesa"
}

# Runs a command as root, directly or through sudo.
asRoot() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null 2>&1; then
    sudo "$@"
  else
    echo "bootstrap: installing packages needs root: run this script as root, or install sudo" >&2
    exit 1
  fi
}

# Adds bookworm-backports from the archive that the machine's own apt configuration uses for bookworm.
addBackports() {
  if apt-get indextargets --format '$(CODENAME)' 'Created-By: Packages' | grep -qx bookworm-backports; then return; fi
  local uri
  uri=$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(REPO_URI)' 'Created-By: Packages' |
    awk '$1 == "bookworm" && $2 == "main" { print $3; exit }')
  if [ -z "$uri" ]; then
    echo "bootstrap: apt knows no 'bookworm main' source, so the address of bookworm-backports is unknown;" >&2
    echo "           add a Debian 12 source to /etc/apt/sources.list and run this again" >&2
    exit 1
  fi
  echo "bootstrap: adding bookworm-backports (for Mesa) to /etc/apt/sources.list.d/volmark-backports.sources"
  printf 'Types: deb\nURIs: %s\nSuites: bookworm-backports\nComponents: main\nSigned-By: %s\n' \
    "$uri" /usr/share/keyrings/debian-archive-keyring.gpg |
    asRoot tee /etc/apt/sources.list.d/volmark-backports.sources >/dev/null
}

case "${1:-}" in
  '' | --check) ;;
  --help | -h) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac

if ! command -v dpkg-query >/dev/null 2>&1; then
  echo "bootstrap: this script installs Debian packages, and this system has no dpkg; see README.md for the list" >&2
  exit 1
fi
if [ "${1:-}" = --check ]; then
  missing=$(listMissing)
  [ -z "$missing" ] && { echo "bootstrap: nothing is missing"; exit 0; }
  echo "bootstrap: missing:"
  sed 's/^/  /' <<<"$missing"
  exit 1
fi

missing=$(listMissing)
if [ -z "$missing" ]; then
  echo "bootstrap: everything is installed"
  exit 0
fi
export DEBIAN_FRONTEND=noninteractive
echo "bootstrap: refreshing apt's lists"
asRoot apt-get update -qq
wanted=()
for name in "${packages[@]}"; do isInstalled "$name" || wanted+=("$name"); done
if [ "${#wanted[@]}" -gt 0 ]; then
  echo "bootstrap: installing ${#wanted[@]} packages: ${wanted[*]}"
  asRoot env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${wanted[@]}"
fi
if ! mesaIsRecent; then
  addBackports
  asRoot apt-get update -qq
  echo "bootstrap: installing ${backports[*]} from bookworm-backports"
  asRoot env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    -t bookworm-backports "${backports[@]}"
fi
echo "bootstrap: done"
