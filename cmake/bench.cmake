# SPDX-License-Identifier: BSD-3-Clause
# One program per bench/NAME.cpp, built by `./run bench NAME` only: target raven_correction_bench_NAME,
# file bench/NAME in the build folder. What several of them need is in bench/support. Google Benchmark
# is linked where it is installed.
find_package(benchmark QUIET)
include(cmake/test_plant.cmake)
file(GLOB bench_support CONFIGURE_DEPENDS bench/support/*.cpp)
add_library(${PROJECT_NAME}_bench_support STATIC EXCLUDE_FROM_ALL ${bench_support})
target_include_directories(${PROJECT_NAME}_bench_support PUBLIC ${PROJECT_SOURCE_DIR})
target_link_libraries(${PROJECT_NAME}_bench_support PUBLIC ${own_libraries})
file(GLOB bench_sources CONFIGURE_DEPENDS bench/*.cpp)
foreach(source ${bench_sources})
  get_filename_component(name ${source} NAME_WE)
  set(target ${PROJECT_NAME}_bench_${name})
  add_executable(${target} EXCLUDE_FROM_ALL ${source})
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME ${name} RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/bench)
  target_link_libraries(${target} ${PROJECT_NAME}_bench_support CLI11::CLI11 nlohmann_json::nlohmann_json
    OpenMP::OpenMP_CXX $<TARGET_NAME_IF_EXISTS:benchmark::benchmark>)
  if(name STREQUAL "diagnosis")
    target_link_libraries(${target} ${PROJECT_NAME}_test_plant)
  endif()
endforeach()
