#!/usr/bin/env bash
# Installs what the build needs from Debian or Ubuntu packages; asks for nothing that is there already.
#   cmake/install_dependencies.sh [tools|tests|tidy|view|fuzz|package|arm64 [package]|armhf|docs]
# tests, fuzz, package and the cross builds = tools and more, tidy and view = tests and more
set -euo pipefail

packages=(cmake g++ make ninja-build libeigen3-dev libyaml-cpp-dev libcli11-dev libfmt-dev nlohmann-json3-dev
  libbz2-dev liblz4-dev libzstd-dev libsqlite3-dev libwebsockets-dev libjs-dygraphs libjs-three)
python=(pybind11-dev python3-dev python3-numpy)
ros2=(cyclonedds-dev cyclonedds-tools)
foreign=
case "${1:-tools}" in
  tests | tidy | view) packages+=(libgtest-dev libceres-dev python3 valgrind "${python[@]}" python3-pytest python3-distributed
    python3-matplotlib mypy "${ros2[@]}" libfastrtps-dev fastddsgen) ;;&
  tidy) packages+=(clang-format-14 clang-tidy-14) ;;
  view) packages+=(chromium)
    command -v npm >/dev/null || packages+=(npm) ;;
  package) packages+=("${python[@]}" python3-pip python3-setuptools python3-wheel "${ros2[@]}" libgtest-dev lintian dpkg-dev
    file) ;;
  docs) packages=(doxygen python3-sphinx python3-myst-parser) ;;
  arm64) foreign=arm64 packages+=(g++-aarch64-linux-gnu) ;;
  armhf) foreign=armhf packages+=(g++-arm-linux-gnueabihf) ;;
  fuzz) packages+=(clang-14 libclang-rt-14-dev) ;;
esac
if [ -n "$foreign" ]; then
  packages+=(qemu-user python3)
  libraries=(libfmt-dev libbz2-dev liblz4-dev libzstd-dev libsqlite3-dev libgtest-dev)
  [ "${2:-}" != package ] || libraries+=(libwebsockets17 libssl-dev libyaml-cpp0.7 libpython3-dev)
  packages+=("${libraries[@]/%/:$foreign}")
fi

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
[ -z "$foreign" ] || "${as_root[@]}" dpkg --add-architecture "$foreign"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
