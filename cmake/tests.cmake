# SPDX-License-Identifier: BSD-3-Clause
# One gtest executable per room (test/ROOM/*.cpp) and one rostest per test/nodes/*.test with the
# gtest of the same name beside it.
foreach(room ${core_rooms} ros)
  file(GLOB room_tests CONFIGURE_DEPENDS test/${room}/*.cpp)
  if(room_tests)
    catkin_add_gtest(test_${room} ${room_tests} TIMEOUT 300
      WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    target_include_directories(test_${room} PRIVATE test)
    target_include_directories(test_${room} SYSTEM PRIVATE ${LBFGSPP_INCLUDE_DIR})
    target_link_libraries(test_${room} raven_correction_core yaml-cpp
      nlohmann_json::nlohmann_json OpenMP::OpenMP_CXX)
    if(room STREQUAL "ros")
      target_link_libraries(test_${room} raven_correction_ros)
    endif()
  endif()
endforeach()

file(GLOB node_tests CONFIGURE_DEPENDS test/nodes/*.test)
if(node_tests)
  find_package(rostest REQUIRED)
  foreach(launch_file ${node_tests})
    get_filename_component(name ${launch_file} NAME_WE)
    if(EXISTS ${PROJECT_SOURCE_DIR}/test/nodes/${name}.cpp)
      add_rostest_gtest(test_${name} test/nodes/${name}.test test/nodes/${name}.cpp
        DEPENDENCIES ${node_targets})
      target_include_directories(test_${name} PRIVATE test)
      target_link_libraries(test_${name} raven_correction_ros)
    else()
      add_rostest(test/nodes/${name}.test DEPENDENCIES ${node_targets})
    endif()
  endforeach()
endif()
