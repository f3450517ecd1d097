# dep::math: sine, exponential and their like. The C standard leaves their last bits to each C library (and glibc chooses among its own by
# the processor it runs on); a diagnosis shows them in its last digits. From musl's sources in MUSL_SOURCE_DIR they are the same code
# everywhere, that of wasi-libc in the browser too; without them they are this machine's, and so are those digits.
set(MUSL_SOURCE_DIR "$ENV{MUSL_SOURCE_DIR}" CACHE PATH "musl's sources, for results that are the same on every machine")
add_library(dep_math INTERFACE)
add_library(dep::math ALIAS dep_math)
if(MUSL_SOURCE_DIR)
    # What the host's rooms call, and what that calls. Whatever IEEE 754 defines to the last bit stays the compiler's.
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
    # Neither may a compiler put a constant's sine where the call stands: it has its own idea of the last bit.
    add_compile_options(-fno-builtin-sin -fno-builtin-cos -fno-builtin-tan -fno-builtin-exp -fno-builtin-expm1 -fno-builtin-cosh
        -fno-builtin-log -fno-builtin-log10 -fno-builtin-pow -fno-builtin-hypot -fno-builtin-atan -fno-builtin-atan2
        -fno-builtin-cabs -fno-builtin-carg -fno-builtin-cexp)
    target_link_libraries(dep_math INTERFACE musl_math)
else()
    message(STATUS "MUSL_SOURCE_DIR is empty: sine and its like are this machine's, and with them the last digits of results")
endif()
target_link_libraries(dep_math INTERFACE m)
