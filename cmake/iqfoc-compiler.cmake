# Compiler settings for every target of a top-level build: language levels, warnings as errors, sanitizers, coverage, ccache.
# Never read by a parent project or under a foreign toolchain file.

set(CMAKE_C_STANDARD 11)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# The host's parts go into shared libraries too; nobody replaces a function of theirs from outside.
if(NOT IQFOC_TARGET)
    set(CMAKE_POSITION_INDEPENDENT_CODE ON)
    add_compile_options(-fno-semantic-interposition)
endif()

# Debug information holds lines and functions only: the types of Eigen take most of a compiler's memory. Nothing throws (base/memory.h), and
# code for exceptions takes a third of the time of the JSON and TOML units.
if(NOT IQFOC_TARGET)
    add_compile_options($<$<CONFIG:RelWithDebInfo>:-g1> $<$<COMPILE_LANGUAGE:CXX>:-fno-exceptions>)
endif()
# For the files through which an FMU catches std::bad_alloc; WebAssembly has no exceptions.
if(NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "wasm32")
    set(iqfoc_exceptions -fexceptions)
endif()

option(IQFOC_SANITIZE "Address and undefined-behaviour sanitizers, for the library also the integer one (clang)" OFF)
option(IQFOC_FUZZ "Build the fuzzers (clang, with IQFOC_SANITIZE)" OFF)
option(IQFOC_COVERAGE "Count executed lines and branches (gcc)" OFF)

add_compile_options(-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
                    $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes>)

# A product whose sum is fused on one machine and not on the other differs in the last bit; results are
# compared across compilers, so that no compiler may fuse.
add_compile_options(-ffp-contract=off)

if(IQFOC_SANITIZE)
    if(NOT CMAKE_C_COMPILER_ID STREQUAL "Clang")
        message(FATAL_ERROR "IQFOC_SANITIZE needs clang (preset asan), the compiler is ${CMAKE_C_COMPILER_ID}")
    endif()
    add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
    add_link_options(-fsanitize=address,undefined)
endif()

# Every file counts its branches for the fuzzer; the fuzzer itself is linked by who is one.
if(IQFOC_FUZZ)
    add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# The library and its tests, whose headers hold functions too, count every line; the host's parts, which only drive them, are optimised.
set(iqfoc_counted "")
if(IQFOC_COVERAGE)
    if(NOT CMAKE_C_COMPILER_ID STREQUAL "GNU")
        message(FATAL_ERROR "IQFOC_COVERAGE needs gcc (preset coverage), the compiler is ${CMAKE_C_COMPILER_ID}")
    endif()
    set(iqfoc_counted --coverage -O0)
    add_link_options(--coverage)
endif()

option(IQFOC_STATIC "Link the program statically: one file that needs nothing of the machine it runs on" OFF)
if(IQFOC_STATIC)
    add_link_options(-static)
endif()

# The simulation and the fit of a recording take the time that their user waits for. Two scalars of a drive packed into one vector are
# read back before both are written: without that it is 5 to 10 % faster, and not a digit else.
set(iqfoc_where_time_goes "")
if(NOT IQFOC_SANITIZE AND NOT IQFOC_COVERAGE)
    set(iqfoc_where_time_goes $<$<NOT:$<CONFIG:Debug>>:-O3 -fno-tree-slp-vectorize>)
endif()
# Modules that run for milliseconds: the same digits, compiled in two thirds of the time.
set(iqfoc_cold $<$<CONFIG:RelWithDebInfo>:-O1>)

find_program(IQFOC_CCACHE ccache)
if(IQFOC_CCACHE AND NOT DEFINED CMAKE_C_COMPILER_LAUNCHER)
    set(CMAKE_C_COMPILER_LAUNCHER ${IQFOC_CCACHE})
    set(CMAKE_CXX_COMPILER_LAUNCHER ${IQFOC_CCACHE})
endif()
