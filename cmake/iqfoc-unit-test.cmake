# Unity, and the one way to add a test:
#   iqfoc_add_test(NAME name SOURCES a.c [b.c...] [LIBS x y...] [TIMEOUT seconds] [LABELS l...])
# builds the sources with Unity and registers the program with ctest. TIMEOUT is processor time, so that a loaded machine fails no test;
# sanitizers and coverage get five times as much. A test with the label `sweep` is exhaustive and slow: it runs in one optimised build
# only. IQFOC_TESTS=quick leaves out `sweep` and `study`.
if(NOT BUILD_TESTING)
    return()
endif()

find_path(UNITY_DIR unity.c
    HINTS $ENV{UNITY_DIR} ${PROJECT_SOURCE_DIR}/.cache/unity
    PATHS /usr/share/cmock/vendor/unity/src
    NO_DEFAULT_PATH
    DOC "Folder of unity.c, unity.h and unity_internals.h")
if(NOT UNITY_DIR)
    message(FATAL_ERROR "The test framework Unity is missing. `./dev test` fetches it; or set UNITY_DIR to the folder of "
                        "unity.c (Debian 13: package cmock); or build without tests: -DBUILD_TESTING=OFF")
endif()

add_library(unity STATIC ${UNITY_DIR}/unity.c)
target_include_directories(unity SYSTEM PUBLIC ${UNITY_DIR})
target_compile_definitions(unity PUBLIC UNITY_INCLUDE_DOUBLE UNITY_SUPPORT_64)
target_compile_options(unity PRIVATE -w)

# A command's start: the seconds of processor time that it, and each process that it starts, may take. A soft limit: what is started may
# set its own.
set(IQFOC_WITHIN sh -c "ulimit -S -t \"$0\" && exec \"$@\"")

function(iqfoc_add_test)
    cmake_parse_arguments(PARSE_ARGV 0 test "" "NAME;TIMEOUT" "SOURCES;LIBS;LABELS")
    if(NOT test_NAME OR NOT test_SOURCES OR test_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR "iqfoc_add_test needs NAME and SOURCES; not understood: '${test_UNPARSED_ARGUMENTS}'")
    endif()
    if(IQFOC_TESTS STREQUAL quick AND "${test_LABELS}" MATCHES "sweep|study")
        return()
    endif()
    if(NOT test_TIMEOUT)
        set(test_TIMEOUT 120)
    endif()
    if(IQFOC_SANITIZE OR IQFOC_COVERAGE)
        math(EXPR test_TIMEOUT "${test_TIMEOUT} * 5")
    endif()
    add_executable(test_${test_NAME} ${test_SOURCES})
    set_target_properties(test_${test_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
    target_link_libraries(test_${test_NAME} PRIVATE ${test_LIBS} unity dep::math)
    target_compile_options(test_${test_NAME} PRIVATE ${iqfoc_counted})
    add_test(NAME ${test_NAME} COMMAND ${IQFOC_WITHIN} ${test_TIMEOUT} $<TARGET_FILE:test_${test_NAME}>
        WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${test_NAME} PROPERTIES LABELS "${test_LABELS}")
endfunction()
