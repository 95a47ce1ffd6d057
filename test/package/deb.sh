#!/usr/bin/env bash
# The Debian packages: builds them, asks lintian, unpacks them into a root of their own; there the program and the
# Python package replay the sample flight to the same bits, and a foreign project builds and runs. The package that
# `pip install ./src/python` makes is tried likewise.
#   test/package/deb.sh [BUILD [ARCH]]     an existing build folder is used again
# For another architecture they are cross-built, and the program runs under qemu-user.
set -euo pipefail
cd "$(dirname "$0")/../.."
source=$PWD
build=${1:-build/package}
host=$(dpkg --print-architecture)
arch=${2:-$host}
cross=()
emulator=()
if [ "$arch" != "$host" ]; then
  what=package
  . test/cross_build.sh
  emulator=("$qemu" -L /)
fi
[ -f "$build/CMakeCache.txt" ] || cmake -G Ninja -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DRIO_BUILD_TESTS=OFF \
  -DRIO_BUILD_EXAMPLES=OFF "${cross[@]}"
[ "$arch" != "$host" ] || cross=(-DRIO_BUILD_ROS2=ON)
cmake -B "$build" -DCMAKE_INSTALL_PREFIX=/usr -DBUILD_SHARED_LIBS=ON -DRIO_BUILD_PYTHON=ON "${cross[@]}" \
  -DPython3_EXECUTABLE=/usr/bin/python3 >/dev/null
cmake --build "$build" --target package -j "$(nproc)"
version=$("${emulator[@]}" "$build"/src/tools/rio --version | sed -n '1s/ .*//p')
cd "$build"
# the address is that of who builds: DEBFULLNAME, DEBEMAIL
lintian --allow-root --fail-on error --tag-display-limit 0 \
  --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog ./*_"$version"_*.deb

root=$PWD/root
rm -rf "$root" consumer
for package in ./*_"$version"_"$arch".deb; do dpkg -x "$package" "$root"; done
libraries=$(dirname "$(find "$root/usr" -name 'librio.so.*' | head -1)")
consumer() {
  cmake -G Ninja -S "$source/test/package/consumer" -B consumer -DCMAKE_PREFIX_PATH="$root/usr" \
    -DCMAKE_BUILD_TYPE=Release -DEXAMPLES="$root/usr/share/rio/examples" "$@" >/dev/null
  cmake --build consumer
}
programs=(link driver autopilot research core new_model)
if [ "$arch" != "$host" ]; then
  emulator+=(-E "LD_LIBRARY_PATH=$libraries")
  "${emulator[@]}" "$root/usr/bin/rio" replay "$source/data/sample_flight" --out flight.tum
  test -s "$root"/usr/share/man/man1/rio.1.gz
  consumer -DCMAKE_TOOLCHAIN_FILE="$source/cmake/toolchain/$arch.cmake" "${cross[@]:1}" --no-warn-unused-cli
  for program in "${programs[@]}"; do "${emulator[@]}" "consumer/$program" >/dev/null; done
  echo "Packages of $arch: ok; Python package not run"
  exit
fi
export LD_LIBRARY_PATH=$libraries
"$root/usr/bin/rio" --version
"$root/usr/bin/rio-ros2" --print-params | head -3
"$root/usr/bin/rio" replay "$source/data/sample_flight" --out flight.tum
# The Python package in that folder replays to the bytes of the program.
python_replays_alike() {
  PYTHONPATH=$1 /usr/bin/python3 - "$source/data/sample_flight" flight.tum <<'CHECK'
import pathlib, sys
import rio
rio.replay(sys.argv[1]).write_tum("python.tum")
same = pathlib.Path("python.tum").read_bytes() == pathlib.Path(sys.argv[2]).read_bytes()
print("Python package:", rio.__file__, "the same bytes" if same else "OTHER BYTES")
sys.exit(not same)
CHECK
}
python_replays_alike "$root/usr/lib/python3/dist-packages"
rm -rf by_pip
/usr/bin/python3 -m pip install --quiet --target by_pip --no-index --no-deps --no-build-isolation "$source/src/python"
python_replays_alike by_pip
consumer
for program in "${programs[@]}" new_model_test; do "consumer/$program" >/dev/null; done
echo "Packages: ok"
