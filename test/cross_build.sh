# Sourced by cross.sh and package/deb.sh from the top folder, with $arch and $what, nothing or "package": installs what
# a cross build needs, sets $cross, the options of cmake, $root, the folder of what was only unpacked, and $qemu.
[ -f "cmake/toolchain/$arch.cmake" ] || { echo "no cmake/toolchain/$arch.cmake" >&2; exit 1; }
cmake/install_dependencies.sh "$arch" $what
case "$arch" in
  arm64) qemu=qemu-aarch64 triplet=aarch64-linux-gnu ;;
  armhf) qemu=qemu-arm triplet=arm-linux-gnueabihf ;;
esac
root=$PWD/build/$arch/root
unpacked=("libyaml-cpp-dev:$arch" "libyaml-cpp0.7:$arch")  # installed, their headers would replace those of this machine
cross=(-DCMAKE_TOOLCHAIN_FILE="cmake/toolchain/$arch.cmake" -Dyaml-cpp_DIR="$root/usr/lib/$triplet/cmake/yaml-cpp"
  -DCMAKE_EXE_LINKER_FLAGS="-L$root/usr/lib/$triplet" -DCMAKE_MODULE_LINKER_FLAGS="-L$root/usr/lib/$triplet")
if [ "$what" = package ]; then
  cross+=(-DPython3_INCLUDE_DIR="/usr/include/$(/usr/bin/python3 -c 'import sys; print("python%d.%d" % sys.version_info[:2])')")
  export _PYTHON_SYSCONFIGDATA_NAME="_sysconfigdata__$triplet"  # for the name of the module
  unpacked+=("libwebsockets-dev:$arch" "libwebsockets17:$arch")
  cross+=(-DLIBWEBSOCKETS_INCLUDE_DIR="$root/usr/include" -DLIBWEBSOCKETS_LIBRARY="$root/usr/lib/$triplet/libwebsockets.so")
fi
mkdir -p "$root"
for package in "${unpacked[@]}"; do
  [ -e "$root/$package" ] || (cd "$root" && apt-get download -qq "$package" && dpkg -x "${package%%:*}"_*.deb . && touch "$package")
done
