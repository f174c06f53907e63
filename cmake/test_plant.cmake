# SPDX-License-Identifier: BSD-3-Clause
# The independent plant of test/plant, for tests and benchmarks that hide effects in its recordings:
# a static library, built only where one of them links it. Its own tests are in cmake/tests.cmake.
include_guard(GLOBAL)
file(GLOB plant_sources CONFIGURE_DEPENDS test/plant/*.cpp)
list(FILTER plant_sources EXCLUDE REGEX "_test\\.cpp$")
add_library(${PROJECT_NAME}_test_plant STATIC EXCLUDE_FROM_ALL ${plant_sources})
target_compile_options(${PROJECT_NAME}_test_plant PRIVATE -Wconversion -Wno-sign-conversion)
target_include_directories(${PROJECT_NAME}_test_plant PUBLIC ${PROJECT_SOURCE_DIR}/test)
target_link_libraries(${PROJECT_NAME}_test_plant PUBLIC ${PROJECT_NAME}_core)
