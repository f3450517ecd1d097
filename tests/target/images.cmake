# Test images for an emulated board; tests/target/run.sh builds and runs them. They want Unity's sources in UNITY_DIR.
set(EMULATED ${PROJECT_SOURCE_DIR}/port/emulated)

add_library(unity STATIC ${UNITY_DIR}/unity.c)
target_include_directories(unity SYSTEM PUBLIC ${UNITY_DIR})
target_compile_definitions(unity PUBLIC UNITY_INCLUDE_DOUBLE UNITY_SUPPORT_64 UNITY_INCLUDE_CONFIG_H)
target_include_directories(unity PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/unity)
target_compile_options(unity PRIVATE -w)
target_link_libraries(unity PUBLIC port)

# The library's own port on the emulated board: HAL and the stand-in drive behind it.
add_library(emulated_drive STATIC ${EMULATED}/hal_emulated.c ${EMULATED}/small_drive.c ${EMULATED}/small_drive_sample.c)
target_link_libraries(emulated_drive PUBLIC iqfoc port)

iqfoc_add_image(test_interrupts test_interrupts.c)
target_link_libraries(test_interrupts PRIVATE emulated_drive unity)

# A clear interrupted at each of its instructions, as three optimisations write them.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL arm)
    foreach(level O0 Os O2)
        iqfoc_add_image(test_clear_${level} test_clear_boundaries.c ${PROJECT_SOURCE_DIR}/src/cycle.c)
        target_compile_options(test_clear_${level} PRIVATE -${level})
        target_link_libraries(test_clear_${level} PRIVATE unity)
    endforeach()
endif()

# The start-up and link.ld of the STM32G474's port, with the memories where QEMU's board has some: its CCM SRAM is the board's PSRAM.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL arm)
    set(stm32g4 ${PROJECT_SOURCE_DIR}/port/stm32g4)
    file(READ ${stm32g4}/link.ld text)
    string(REPLACE "ORIGIN = 0x08000000" "ORIGIN = 0x00000000" text "${text}")
    string(REPLACE "ORIGIN = 0x10000000" "ORIGIN = 0x21000000" text "${text}")
    file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/ccm.ld "${text}")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${stm32g4}/link.ld)
    set(board ${PROJECT_SOURCE_DIR}/port/cortex-m4)
    add_executable(test_ccm test_ccm.c ${stm32g4}/startup.c ${stm32g4}/hal_stm32g4.c ${board}/console.c ${board}/semihost_call.c
                   ${EMULATED}/console.c)
    set_target_properties(test_ccm PROPERTIES SUFFIX .elf LINK_DEPENDS ${CMAKE_CURRENT_BINARY_DIR}/ccm.ld)
    target_include_directories(test_ccm PRIVATE ${stm32g4} ${board} ${EMULATED})
    target_link_libraries(test_ccm PRIVATE iqfoc)
    target_link_options(test_ccm PRIVATE -nostartfiles --specs=nano.specs -Wl,--gc-sections -T${CMAKE_CURRENT_BINARY_DIR}/ccm.ld)
endif()

# The run has a clock of its own in place of the board's.
add_subdirectory(golden)
iqfoc_add_image(same_bits same_bits.c closed_loop.c ${EMULATED}/hal_emulated.c ${EMULATED}/small_drive.c ${EMULATED}/small_drive_sample.c)
target_link_libraries(same_bits PRIVATE golden)
target_compile_definitions(same_bits PRIVATE IQFOC_ON_TARGET)

# The library's own unit tests. Sweeps are thinned: double precision is emulated twice here. Fewer draws than these, and a
# test no longer sees errors as large as its two-sided bounds want.
function(add_unit_image name stride)
    iqfoc_add_image(unit_${name} ../unit/library/test_${name}.c ${IQFOC_TARGET_SYSCALLS})
    target_compile_definitions(unit_${name} PRIVATE IQFOC_TEST_STRIDE=${stride})
    target_link_libraries(unit_${name} PRIVATE unity m)
endfunction()
foreach(name IN ITEMS iq24 iq24_math cycle)
    add_unit_image(${name} 1009)
endforeach()
# Cortex-M0+ differs in its multiply alone: these three, and same_bits for the rest.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL armv6-m)
    return()
endif()
foreach(name IN ITEMS rotor transform predictor modulation current_control cycle_loop)
    add_unit_image(${name} 1009)
endforeach()
# The assembly for Cortex-M0+, which the Cortex-M4's board runs too, against the C: all angles and speeds.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL arm)
    set(library ${PROJECT_SOURCE_DIR}/src)
    add_library(thumb1 OBJECT ${library}/arm_muls.c ${library}/arm_rotor.c ${library}/arm_sincos.c)
    target_include_directories(thumb1 PRIVATE ${PROJECT_SOURCE_DIR}/include)
    target_compile_options(thumb1 PRIVATE -mcpu=cortex-m0plus)
    iqfoc_add_image(test_assembly test_assembly.c $<TARGET_OBJECTS:thumb1>)
    target_compile_definitions(test_assembly PRIVATE IQFOC_TARGET_HEADER=<stdint.h>)
    target_link_libraries(test_assembly PRIVATE unity)
endif()
add_unit_image(extension 20)
add_unit_image(finite_set 50)
