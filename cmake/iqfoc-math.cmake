# dep::math: sine, exponential and similar functions. The C standard leaves their last bits to each C library, and glibc selects among its own
# versions by processor. A diagnosis shows the difference in its 17 digits. musl's sources in MUSL_SOURCE_DIR are the same code everywhere,
# also that of wasi-libc in the browser. Without them the functions are this machine's.
set(MUSL_SOURCE_DIR "$ENV{MUSL_SOURCE_DIR}" CACHE PATH "musl's sources, for results that are the same on every machine")
add_library(dep_math INTERFACE)
add_library(dep::math ALIAS dep_math)
if(MUSL_SOURCE_DIR)
    # Results take their last digits from these files: no other version is compiled.
    include(${CMAKE_CURRENT_LIST_DIR}/iqfoc-pins.cmake)
    iqfoc_pinned(${MUSL_SOURCE_DIR} ${CMAKE_CURRENT_LIST_DIR}/../packages/musl.sha256 musl_wrong)
    if(musl_wrong)
        message(FATAL_ERROR "${MUSL_SOURCE_DIR}/${musl_wrong} is not the file that packages/musl.sha256 pins")
    endif()
    # The functions that the host's modules call, and the functions that these call. Whatever IEEE 754 defines to the last bit stays the compiler's.
    foreach(file IN ITEMS
            sin cos tan sincos __sin __cos __tan __rem_pio2 __rem_pio2_large
            exp exp_data expm1 cosh __expo2 log log_data log10 pow pow_data
            __math_invalid __math_divzero __math_oflow __math_uflow __math_xflow
            hypot atan atan2 erf ../complex/cabs ../complex/carg ../complex/cexp ../complex/__cexp)
        list(APPEND musl_sources ${MUSL_SOURCE_DIR}/src/math/${file}.c)
    endforeach()
    # musl's own headers are not there, and glibc's declare some of its inner names as something else.
    file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/musl_names.h @ONLY CONTENT [[
#include <math.h>
#define hidden __attribute__((__visibility__("hidden")))
#define __sin musl_sin
#define __cos musl_cos
#define __tan musl_tan
#define __sinl musl_sinl
#define __cosl musl_cosl
#define __tanl musl_tanl
]])
    add_library(musl_math STATIC EXCLUDE_FROM_ALL ${musl_sources})
    target_include_directories(musl_math PRIVATE ${MUSL_SOURCE_DIR}/src/internal ${MUSL_SOURCE_DIR}/arch/generic)
    # Others' code: neither its warnings nor a sanitizer's are ours to mend. Where a processor fuses, musl would take another way.
    target_compile_options(musl_math PRIVATE -w -fno-sanitize=all -fno-builtin -U__FP_FAST_FMA
        "SHELL:-include ${CMAKE_BINARY_DIR}/musl_names.h")
    target_compile_definitions(musl_math PRIVATE _GNU_SOURCE)
    # The compiler may not replace the sine of a constant by a number either: its last bit may differ.
    add_compile_options(-fno-builtin-sin -fno-builtin-cos -fno-builtin-tan -fno-builtin-exp -fno-builtin-expm1 -fno-builtin-cosh
        -fno-builtin-log -fno-builtin-log10 -fno-builtin-pow -fno-builtin-hypot -fno-builtin-atan -fno-builtin-atan2
        -fno-builtin-cabs -fno-builtin-carg -fno-builtin-cexp)
    target_link_libraries(dep_math INTERFACE musl_math)
else()
    message(STATUS "MUSL_SOURCE_DIR is empty: sine and its like are this machine's, and with them the last digits of results")
endif()
target_link_libraries(dep_math INTERFACE m)
