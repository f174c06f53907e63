# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Configure and build into $build, only when something changed, and run in the built environment.
# Expects report.sh, packages.sh, $root and $build.
: "${root:?}" "${build:?}" "${installed_something:?}"

jobs=${RAVEN_JOBS:-$(nproc)}
cmake_options=() # beyond the usual; once given they stay in the cache

# source_setup FILE: a setup.bash of ROS, which reads variables that are not set
source_setup() {
  set +u
  # shellcheck disable=SC1090
  source "$1"
  set -u
}

# forget_foreign_build: the folder was copied or moved with its build, whose paths are wrong now
forget_foreign_build() {
  local cache=$build/CMakeCache.txt
  if [[ -e $cache ]] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$cache"; then
    say "the build folder was made for another place, making it anew"
    rm -rf "$build"
  fi
}

# configure: runs cmake if it never ran here, if packages were just installed, or if an option is
# not in the cache yet
configure() {
  local cache=$build/CMakeCache.txt option needed=$installed_something
  [[ -e $cache && -e $build/Makefile ]] || needed=yes
  for option in "${cmake_options[@]}"; do
    option=${option#-D}
    [[ -e $cache ]] && grep -qE "^${option%%=*}:[A-Z]+=${option#*=}\$" "$cache" || needed=yes
  done
  [[ $needed == yes ]] || return 0
  say "configuring"
  cmake -S "$root" -B "$build" -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_INSTALL_PREFIX="$root/install" -DCMAKE_TARGET_MESSAGES=OFF \
    "${cmake_options[@]}" >"$build/configure.log" 2>&1 || {
    cat "$build/configure.log" >&2
    fail "cmake could not configure the package (see above)"
  }
  grep -A3 'CMake Warning' "$build/configure.log" >&2 || true
}

# changed_since FILE: true if FILE is absent or a source of the build is newer
changed_since() {
  [[ -e $1 ]] || return 0
  local -a sources=()
  local source
  for source in CMakeLists.txt package.xml nodelets.xml cmake cfg include src msg srv launch test bench fuzz; do
    [[ ! -e $root/$source ]] || sources+=("$root/$source")
  done
  [[ -n $(find "${sources[@]}" -newer "$1" -print -quit) ]]
}

# build_targets NAME TARGET...: builds them unless nothing changed since NAME was built last
build_targets() {
  local name=$1 stamp=$build/.built-$1 start
  shift
  mkdir -p "$build"
  (
    flock 9 # two of us at once: the second waits, and then finds its work done
    if [[ $installed_something == yes ]] || changed_since "$stamp"; then
      start=$(mktemp "$build/.start-XXXXXX")
      configure
      say "building $name ($jobs jobs)"
      if ! cmake --build "$build" --target "$@" -- -j"$jobs" >&2; then
        rm -f "$start"
        fail "the build failed (see above)"
      fi
      mv -f "$start" "$stamp"
    fi
  ) 9>"$build/.lock"
}

# in_environment COMMAND...: becomes COMMAND, where roslaunch and rosservice know the package, and its programs are
# commands: rosrun looks for none in a folder `build` inside the package
in_environment() {
  [[ -e $build/devel/setup.bash ]] || fail "no $build/devel/setup.bash: the build is not complete"
  source_setup "$build/devel/setup.bash"
  export RAVEN_ROOT=$root RAVEN_BUILD=$build PATH=$PATH:$build/devel/lib/raven_correction
  exec "$@"
}
