# SPDX-License-Identifier: BSD-3-Clause
# One program per fuzz/NAME.cpp, built by `./run fuzz` only: target raven_correction_fuzz_NAME, file
# fuzz/NAME in the build folder. libFuzzer comes with clang, and so does the instrumentation that all
# our libraries need: scripts/lib/sanitize.sh gives both.
file(GLOB fuzz_sources CONFIGURE_DEPENDS fuzz/*.cpp)
foreach(source ${fuzz_sources})
  get_filename_component(name ${source} NAME_WE)
  set(target ${PROJECT_NAME}_fuzz_${name})
  add_executable(${target} EXCLUDE_FROM_ALL ${source})
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME ${name} RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/fuzz)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/test)
  target_link_libraries(${target} ${own_libraries})
  target_link_options(${target} PRIVATE -fsanitize=fuzzer)
endforeach()
