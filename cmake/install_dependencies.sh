#!/usr/bin/env bash
# Installs what the build needs from Debian or Ubuntu packages; asks for nothing that is there already.
#   cmake/install_dependencies.sh [tools|tests|tidy|fuzz]     tests, fuzz = tools and more, tidy = tests and more
set -euo pipefail

packages=(cmake g++ make ninja-build libeigen3-dev libyaml-cpp-dev libcli11-dev libfmt-dev nlohmann-json3-dev
  libbz2-dev liblz4-dev libzstd-dev libsqlite3-dev libwebsockets-dev libjs-dygraphs libjs-three)
case "${1:-tools}" in
  tests | tidy) packages+=(libgtest-dev libceres-dev valgrind) ;;&
  tidy) packages+=(libbenchmark-dev clang-format-14 clang-tidy-14) ;;
  fuzz) packages+=(clang-14 libclang-rt-14-dev) ;;
esac

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "Please install as root: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "Installing: ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
