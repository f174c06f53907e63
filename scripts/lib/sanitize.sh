# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Tests and broken input under the sanitizers of clang, in builds of their own below $build. What a
# sanitizer finds is written to reports/ there, because a node that ends so is nobody's failure else.
# Expects report.sh, packages.sh, build.sh, prepare, $root and $build.
: "${root:?}" "${build:?}" "${jobs:?}"

# sanitizer_build KIND: from here on $build is a build of its own, with asserts (also Eigen's)
sanitizer_build() {
  local flags="-O1 -gline-tables-only -fno-omit-frame-pointer"
  case $1 in
    # fuzzer-no-link counts what code is reached: the fuzz targets need it, so one build serves both.
    address)
      flags+=" -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=all"
      flags+=" -fsanitize-ignorelist=$root/test/sanitize/ignore.txt"
      ;;
    thread) flags+=" -fsanitize=thread" ;;
  esac
  export CXX=clang++
  build=$root/build/sanitize-$1
  # shellcheck disable=SC2034  # read by build.sh
  cmake_options=(-DCMAKE_BUILD_TYPE=Sanitize "-DCMAKE_CXX_FLAGS_SANITIZE=$flags"
    -DRAVEN_CORRECTION_WERROR=OFF -DRAVEN_CORRECTION_FUZZ=ON)
  mkdir -p "$build/reports"
}

# archer: tells ThreadSanitizer how OpenMP orders its threads
archer() {
  local library
  library=$(clang++ -print-file-name=libarcher.so)
  [[ -e $library ]] || library=$(find /usr/lib/llvm-*/lib -name libarcher.so -print -quit)
  [[ -e $library ]] || fail "libarcher.so is not there: it comes with libomp-dev"
  printf '%s\n' "$library"
}

# sanitizer_options KIND: what the programs read from their environment
sanitizer_options() {
  local lists=$root/test/sanitize common
  common=log_path=$build/reports/report:print_stacktrace=1
  case $1 in
    address)
      export ASAN_OPTIONS=$common:detect_stack_use_after_return=1 UBSAN_OPTIONS=$common
      export LSAN_OPTIONS=suppressions=$lists/leaks.supp:print_suppressions=0
      ;;
    thread)
      export TSAN_OPTIONS=$common:suppressions=$lists/threads.supp:print_suppressions=0
      TSAN_OPTIONS+=:ignore_noninstrumented_modules=1:second_deadlock_stack=1
      TSAN_OPTIONS+=:die_after_fork=0 # tests fork a process with threads of its own, to kill it
      OMP_TOOL_LIBRARIES=$(archer)
      export OMP_TOOL_LIBRARIES
      ;;
  esac
}

# too_slow: the filter of GoogleTest that leaves out what takes hours under a sanitizer
too_slow() { printf -- '-%s\n' "$(grep -v -e '^#' -e '^$' "$root/test/sanitize/too_slow.txt" | paste -sd:)"; }

# sanitized_test TEST: prints the program's target and the target that runs it
sanitized_test() {
  local program=raven_correction_test_$1
  if [[ -e $root/test/nodes/$1.test ]]; then
    [[ -e $root/test/nodes/$1.cpp ]] || program=all
    printf '%s\n' "$program" "run_tests_raven_correction_rostest_test_nodes_$1.test"
  elif compgen -G "$root/test/$1/*_test.cpp" >/dev/null; then
    [[ $1 != plant ]] || program=raven_correction_test_of_plant
    printf '%s\n' "$program" "run_tests_raven_correction_gtest_$1"
  else
    refuse "there is no test '$1': neither test/$1/*_test.cpp nor test/nodes/$1.test"
  fi
}

# sanitizer_reports: shows them; 1 if there are any
sanitizer_reports() {
  local report
  local -a reports
  mapfile -t reports < <(find "$build/reports" -type f -size +0 | sort)
  for report in "${reports[@]}"; do
    printf '%s:\n' "$report"
    head -n 60 "$report"
  done
  printf '%s\n' "${#reports[@]} reports of the sanitizers"
  ((${#reports[@]} == 0))
}

command_sanitize() {
  local kind=${1:-all} test status=0
  case $kind in
    all) # each in a process of its own, because a build changes the environment
      "$root/run" sanitize address && "$root/run" sanitize thread
      return
      ;;
    address | thread) shift ;;
    *) refuse "usage: ./run sanitize [address|thread [TEST...]], TEST a room or the name of a test of a node" ;;
  esac
  local -a tests=("$@") targets not_completed=()
  if ((${#tests[@]} == 0)); then # the rooms, then the nodes; the plant is no code that is used
    for test in "$root"/test/*/*_test.cpp "$root"/test/nodes/*.test; do
      [[ $test == *.test ]] && tests+=("$(basename "$test" .test)") || tests+=("$(basename "$(dirname "$test")")")
    done
    mapfile -t tests < <(printf '%s\n' "${tests[@]}" | grep -vx plant | awk '!seen[$0]++')
  fi
  for test in "${tests[@]}"; do sanitized_test "$test" >/dev/null; done
  prepare "$root/dependencies_test.apt" "$root/dependencies_sanitize.apt"
  sanitizer_build "$kind"
  for test in "${tests[@]}"; do
    mapfile -t targets < <(sanitized_test "$test")
    build_targets "test-$test" "${targets[0]}"
  done
  sanitizer_options "$kind"
  GTEST_FILTER=$(too_slow)
  export GTEST_FILTER
  say "left out, see test/sanitize/too_slow.txt: ${GTEST_FILTER#-}"
  rm -rf "$build/test_results" "$build/reports"
  mkdir -p "$build/reports"
  for test in "${tests[@]}"; do
    mapfile -t targets < <(sanitized_test "$test")
    say "running $test"
    cmake --build "$build" --target "${targets[1]}" -- -j"$jobs" >&2 || not_completed+=("$test")
  done
  sanitizer_reports || status=1
  python3 "$root/scripts/count_tests.py" "$build/test_results" "${not_completed[@]}" || status=1
  return "$status"
}

command_fuzz() {
  local seconds=60 seed=0 target program status=0 log
  local -a targets=()
  while (($#)); do
    case $1 in
      --seconds | --seed)
        (($# > 1)) || refuse "$1 needs a value"
        [[ $2 =~ ^[1-9][0-9]{0,6}$ ]] || refuse "$1 '$2' is not a whole number above 0"
        [[ $1 == --seconds ]] && seconds=$2 || seed=$2
        shift
        ;;
      *)
        [[ -e $root/fuzz/$1.cpp ]] ||
          refuse "usage: ./run fuzz [--seconds S] [--seed N] [TARGET...], S (60) for all, TARGET one of: $(fuzz_targets | paste -sd ' ')"
        targets+=("$1")
        ;;
    esac
    shift
  done
  ((${#targets[@]} > 0)) || mapfile -t targets < <(fuzz_targets)
  ((seconds >= ${#targets[@]})) || # libFuzzer takes 0 s for no end
    refuse "--seconds $seconds is less than a second for each of ${#targets[@]} targets: ${targets[*]}"
  prepare "$root/dependencies_sanitize.apt"
  sanitizer_build address
  for target in "${targets[@]}"; do build_targets "fuzz-$target" "raven_correction_fuzz_$target"; done
  export RAVEN_ROOT=$root LSAN_OPTIONS=suppressions=$root/test/sanitize/leaks.supp:print_suppressions=0
  for target in "${targets[@]}"; do
    program=$build/fuzz/$target log=$build/fuzz/$target.log
    say "fuzzing $target for $((seconds / ${#targets[@]})) s, corpus in $program.corpus"
    if "$program" -seed="$seed" -max_total_time=$((seconds / ${#targets[@]})) -print_final_stats=1 -timeout=20 -rss_limit_mb=6000 \
      -artifact_prefix="$program." "$program.corpus" >"$log" 2>&1; then
      printf '%-8s %9s inputs, none broke it\n' "$target" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")"
    else
      tail -n 60 "$log"
      printf '%-8s broke; see %s, and again with: RAVEN_ROOT=%s %s %s\n' "$target" "$log" "$root" "$program" \
        "$(sed -n 's/.*Test unit written to //p' "$log" | tail -n 1)"
      status=1
    fi
  done
  return "$status"
}

# fuzz_targets: names of what `fuzz` can run
fuzz_targets() { find "$root/fuzz" -name '*.cpp' -printf '%f\n' | sed 's/\.cpp$//' | sort; }
