# shellcheck shell=sh
# Sourced, at the top of the repository, by the scripts that make a machine with Debian 13 for arm64. They set $debian, the folder
# unpacked by pi3/debian13, and $folder.

: "${debian:?}" "${folder:?}"
root=$folder/root
objects=$folder/objects
libraries=$debian/usr/lib/aarch64-linux-gnu
cache=$(command -v ccache || true)

# Makes an empty root with a shell.
new_root() {
  rm -rf "$root" "$objects"
  mkdir -p "$objects" "$root/bin" "$root/dev" "$root/lib" "$root/proc" "$root/run" "$root/sys"
  cp "$debian/usr/bin/busybox" "$root/bin/"
  ln -s busybox "$root/bin/sh"
  cp -L "$libraries/ld-linux-aarch64.so.1" "$root/lib/"
}

# compiled FILE OPTIONS... -- SOURCES...: compiles a program with the flags of CMakeLists.txt. OPTIONS are for the linker.
compiled() {
  file=$1
  shift
  options=
  while [ "$1" != -- ]; do
    options="$options $1"
    shift
  done
  shift
  built=
  for source in "$@"; do
    object=$objects/$(basename "$source" .cpp).o
    # shellcheck disable=SC2086 # no word, where there is no cache
    [ -e "$object" ] || $cache aarch64-linux-gnu-g++ -std=c++20 -O2 -fPIC -Wall -Wextra -Wpedantic -Wshadow -Wconversion \
      -Wdouble-promotion -Werror -ffp-contract=off -U__ARM_FEATURE_FMA -ffunction-sections -Icore/include -Icore/base -Ifirmware-app/src \
      -Ifirmware-app -isystem "$debian/usr/include" -isystem "$debian/usr/include/libcamera" -isystem /usr/include/eigen3 \
      -c "$source" -o "$object"
    built="$built $object"
  done
  # shellcheck disable=SC2086 # lists of words
  aarch64-linux-gnu-g++ $built -Wl,--gc-sections -Wl,--allow-shlib-undefined $options -o "$file"
}

# Compiles the camera driver, $root/lib/libOcturnCamera.so.
camera_module() {
  camera=firmware-app/src/camera
  compiled "$root/lib/libOcturnCamera.so" -shared "$libraries/libcamera.so.0.4" "$libraries/libcamera-base.so.0.4" \
    "$libraries/libturbojpeg.so.0" -- \
    $camera/camera_defaults.cpp $camera/colour_picture.cpp $camera/frame_rate.cpp $camera/grey_picture.cpp \
    $camera/jpeg_picture.cpp $camera/libcamera_camera.cpp $camera/pixel_formats.cpp core/src/io/error.cpp
}

# with_libraries FILE...: copies the shared libraries of these files.
with_libraries() {
  for needing in "$@"; do
    aarch64-linux-gnu-readelf -d "$needing" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | while read -r library; do
      [ ! -e "$root/lib/$library" ] || continue
      cp -L "$(find "$libraries" -name "$library" | sed q)" "$root/lib/$library"
      (with_libraries "$root/lib/$library")
    done
  done
}

# Packs the root into $folder/initrd.gz.
pack_root() { (cd "$root" && find . | cpio -o -H newc --quiet | gzip -1) >"$folder/initrd.gz"; }
