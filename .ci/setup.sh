# Sourced by demo and check: a bare Debian 12 to a build. Steps that are done are skipped.

fail() {
  echo "$(basename "$0"): $*" >&2
  exit 1
}

# @param $1 an os-release file, for tests
require_machine() {
  local ID= VERSION_ID= PRETTY_NAME= release=${1:-/etc/os-release} why=
  [ -r "$release" ] && . "$release"
  if [ "$ID" != debian ] || [ "$VERSION_ID" != 12 ]; then
    case "$ID $VERSION_ID" in
      "ubuntu 22.04") why=" It lacks the package libtomlplusplus-dev, and its CMake is older than 3.25." ;;
      "ubuntu 24.04") why=" Its packages have the same names, but nobody has tried them." ;;
    esac
    fail "needs Debian 12 (bookworm), and this is ${PRETTY_NAME:-another system}.$why" \
      "The file Containerfile makes a Debian 12 container: docker build -f Containerfile -t touchstone ."
  fi
  local free_mib
  free_mib=$(df -Pm . | awk 'NR == 2 { print $4 }')
  [ "$free_mib" -ge 3000 ] || fail "needs about 3 GB of free disk here, and only $free_mib MiB are free."
}

# install_packages LIST... : installs the packages in these files, one per line
install_packages() {
  local missing=() name
  while read -r name; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || missing+=("$name")
  done < <(cat "$@" | grep -v '^#')
  command -v npm >/dev/null || missing+=(npm)  # only if there is no other npm
  [ ${#missing[@]} -gt 0 ] || return 0
  echo "== Adding Debian packages: ${missing[*]}"
  [ "$(id -u)" = 0 ] || fail "these packages are missing and only root can add them; run it as root, or: sudo apt-get install ${missing[*]}"
  local log=build/packages.log
  mkdir -p build
  { apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"; } \
    >"$log" 2>&1 </dev/null ||
    fail "apt-get could not add the packages (is the network up?); its messages are in $log."
}

# build PRESET [CMAKE_OPTION...] -- [TARGET...]; a folder that is there keeps its options
build() {
  local preset=$1 folder=build/$1 options=()
  [ -e "$folder/CMakeCache.txt" ] || options=(-DTOUCHSTONE_UNITY=ON)
  shift
  while [ $# -gt 0 ] && [ "$1" != -- ]; do options+=("$1"); shift; done
  shift
  echo "== Building $folder (the first time takes some minutes)"
  local log=$folder/build.log
  mkdir -p "$folder"
  { cmake --preset "$preset" "${options[@]}" && cmake --build "$folder" -j 2 ${1:+--target "$@"}; } \
    >"$log" 2>&1 || { tail -n 40 "$log" >&2; fail "the build failed; the whole log is $log."; }
}
