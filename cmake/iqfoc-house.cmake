# What stands around the library where this folder is the top of the build. Included by the top CMakeLists.txt.
cmake_minimum_required(VERSION 3.25)

include(CTest)

# A target of our own: its port, images and examples.
if(IQFOC_TARGET)
    add_subdirectory(port/${IQFOC_TARGET})
    add_subdirectory(examples)
    return()
endif()

enable_language(CXX)
# The program stands at the top of the build folder: build/host/iqfoc.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
include(${PROJECT_SOURCE_DIR}/cmake/iqfoc-dependencies.cmake)
include(${PROJECT_SOURCE_DIR}/cmake/iqfoc-unit-test.cmake)

add_subdirectory(sim_host/base)
add_subdirectory(sim_host/data)
add_subdirectory(sim_host/plant)
add_subdirectory(sim_host/model)
add_subdirectory(port/host)
add_subdirectory(sim_host/drive)
add_subdirectory(sim_host/pil)
add_subdirectory(sim_host/record)
add_subdirectory(sim_host/report)
add_subdirectory(sim_host/reproduce)
add_subdirectory(sim_host/induction)
add_subdirectory(sim_host/diagnose)
add_subdirectory(sim_host/diagnose/show)
add_subdirectory(sim_host/import)
add_subdirectory(sim_host/loops)
add_subdirectory(sim_host/tune)
add_subdirectory(sim_host/commands)
add_subdirectory(examples)

if(BUILD_TESTING)
    add_subdirectory(tests/unit)
    add_subdirectory(tests/cli)
    add_subdirectory(tests/target)
    add_subdirectory(tests/blind)
    add_subdirectory(tools)
endif()
