# SPDX-License-Identifier: BSD-3-Clause
# All tests as catkin tests: one gtest executable per room (test/ROOM/*.cpp), one of the plant that
# hides effects for the diagnosis (test/plant/*_test.cpp), one rostest per
# test/nodes/*.test with the gtest of the same name beside it, every launch file, the lint, the
# package tests (install space, workspace), and tests of processes (with masters of their own).
# `catkin_make run_tests` or `./run test` runs them.

# Tests run in catkin's snapshot of the environment, which names this workspace only: add Debian's
# ROS packages. And a test that hangs must end: after 15 minutes (lint and package: 45, they compile) it
# is killed and counts as failed. Under a sanitizer it has an hour.
if(EXISTS /usr/share/roscpp/package.xml)
  set(append_packages "ROS_PACKAGE_PATH=\"$ROS_PACKAGE_PATH:/usr/share\" exec \"$@\"")
  list(APPEND CATKIN_ENV sh -c ${append_packages} test)
endif()
set(test_environment ${CATKIN_ENV})
set(limit 900)
if(CMAKE_BUILD_TYPE STREQUAL "Sanitize")
  set(limit 3600)
endif()
set(CATKIN_ENV ${test_environment} timeout ${limit})

# --- rooms --------------------------------------------------------------------------------------
# As catkin_add_gtest(), which however insists on running a file with the name of the target.
find_package(GTest QUIET)
if(NOT TARGET GTest::gtest_main)
  message(STATUS "GoogleTest is missing, most tests are left out: ./run test installs it")
endif()
include(cmake/test_plant.cmake)
foreach(room ${core_rooms} plant ros)
  file(GLOB room_tests CONFIGURE_DEPENDS test/${room}/*.cpp)
  if(room STREQUAL "plant")
    list(FILTER room_tests INCLUDE REGEX "_test\\.cpp$")
  endif()
  if(room_tests AND TARGET GTest::gtest_main)
    set(target ${PROJECT_NAME}_test_${room})
    set(library ${PROJECT_NAME}_core)
    if(room STREQUAL "plant")
      set(target ${PROJECT_NAME}_test_of_plant)  # raven_correction_test_plant is the plant itself
    endif()
    if(room MATCHES "^(plant|diagnosis)$")
      list(APPEND library ${PROJECT_NAME}_test_plant)
    endif()
    if(room STREQUAL "ros")
      set(library ${PROJECT_NAME}_ros)
    endif()
    add_executable(${target} EXCLUDE_FROM_ALL ${room_tests})
    set_target_properties(${target} PROPERTIES OUTPUT_NAME test_${room})
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/test)
    target_include_directories(${target} SYSTEM PRIVATE ${LBFGSPP_INCLUDE_DIR} ${MATIO_INCLUDE_DIR})
    target_link_libraries(${target} ${library} yaml-cpp
      nlohmann_json::nlohmann_json OpenMP::OpenMP_CXX ${MATIO_LIBRARY}
      GTest::gtest GTest::gtest_main)
    if(room STREQUAL "ros")
      target_link_libraries(${target} BZip2::BZip2)
    endif()
    add_dependencies(tests ${target})
    set(results ${CATKIN_TEST_RESULTS_DIR}/${PROJECT_NAME}/gtest-${room}.xml)
    catkin_run_tests_target(gtest ${room} gtest-${room}.xml
      COMMAND "$<TARGET_FILE:${target}> --gtest_output=xml:${results}"
      WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
      DEPENDENCIES ${target})
    add_short_name(test_${room} ${target})
  endif()
endforeach()

# --- nodes --------------------------------------------------------------------------------------
file(GLOB node_tests CONFIGURE_DEPENDS test/nodes/*.test)
# On Debian the libraries of ROS bring rostest along, but not GoogleTest: either may be there alone.
find_package(rostest QUIET)
if(NOT rostest_FOUND OR NOT TARGET GTest::gtest_main)
  message(STATUS "rostest or GoogleTest is missing, the tests of the nodes are left out: ./run test installs it")
  set(node_tests)
endif()
foreach(launch_file ${node_tests})
  get_filename_component(name ${launch_file} NAME_WE)
  if(EXISTS ${PROJECT_SOURCE_DIR}/test/nodes/${name}.cpp)
    set(target ${PROJECT_NAME}_test_${name})
    add_rostest_gtest(${target} test/nodes/${name}.test test/nodes/${name}.cpp)
    if(node_targets)
      add_dependencies(${target} ${node_targets} ${nodelet_libraries})  # loaded while they run
    endif()
    set_target_properties(${target} PROPERTIES OUTPUT_NAME test_${name})
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/test)
    target_link_libraries(${target} ${PROJECT_NAME}_ros)
    if(name STREQUAL "panel")
      target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src)
      target_link_libraries(${target} ${panel_libraries})
    endif()
    add_short_name(test_${name} ${target})
  else()
    add_rostest(test/nodes/${name}.test DEPENDENCIES ${node_targets})
  endif()
endforeach()

# --- launch files ---------------------------------------------------------------------------------
file(GLOB launch_files RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS launch/*.launch)
foreach(launch_file ${launch_files})
  roslaunch_add_file_check(${launch_file} IGNORE_UNSET_ARGS DEPENDENCIES ${node_targets})
endforeach()

# --- lint and package: of the source folder as a whole, so only where it is built alone -------------
if(CMAKE_SOURCE_DIR STREQUAL PROJECT_SOURCE_DIR)
  set(CATKIN_ENV ${test_environment} ${CMAKE_COMMAND} -E env RAVEN_BUILD=${CMAKE_BINARY_DIR} timeout 2700)
  set(results ${CATKIN_TEST_RESULTS_DIR}/${PROJECT_NAME})
  set(runner ${PROJECT_SOURCE_DIR}/test/support/run_unittest.py)
  foreach(script lint/test_lint package/test_run package/test_package nodes/corrector_processes
      nodes/debridement nodes/hosts nodes/recorder_processes nodes/repeatability nodes/trainer_processes)
    get_filename_component(name ${script} NAME)
    set(file ${PROJECT_SOURCE_DIR}/test/${script}.py)
    catkin_run_tests_target(python ${name} ${name}.xml
      COMMAND "${PYTHON_EXECUTABLE} '${runner}' '${results}/${name}.xml' '${file}'"
      DEPENDENCIES ${own_libraries} ${node_targets})
  endforeach()
  set(lint ${PROJECT_SOURCE_DIR}/test/lint/lint.py)
  catkin_run_tests_target(lint all lint.xml
    COMMAND "${PYTHON_EXECUTABLE} '${lint}' --build '${CMAKE_BINARY_DIR}' --results '${results}/lint.xml'"
    DEPENDENCIES ${own_libraries} ${node_targets})
endif()
