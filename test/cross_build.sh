# Sourced by cross.sh and package/deb.sh from the top folder, with $arch and $what, nothing or "package": installs what
# a cross build needs, sets $cross, the options of cmake, $yaml, the root of a library, and $qemu.
[ -f "cmake/toolchain/$arch.cmake" ] || { echo "no cmake/toolchain/$arch.cmake" >&2; exit 1; }
cmake/install_dependencies.sh "$arch" $what
case "$arch" in
  arm64) qemu=qemu-aarch64 triplet=aarch64-linux-gnu ;;
  armhf) qemu=qemu-arm triplet=arm-linux-gnueabihf ;;
esac
yaml=$PWD/build/$arch/yaml-cpp  # its headers; installed, they would replace those of this machine
if [ ! -d "$yaml/usr" ]; then
  mkdir -p "$yaml"
  (cd "$yaml" && apt-get download -qq "libyaml-cpp-dev:$arch" "libyaml-cpp0.7:$arch" &&
    for package in *.deb; do dpkg -x "$package" .; done)
fi
cross=(-DCMAKE_TOOLCHAIN_FILE="cmake/toolchain/$arch.cmake" -Dyaml-cpp_DIR="$yaml/usr/lib/$triplet/cmake/yaml-cpp"
  -DCMAKE_EXE_LINKER_FLAGS="-L$yaml/usr/lib/$triplet")
