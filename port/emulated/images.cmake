# The programs that both emulated boards run. Included by either port's CMakeLists.txt.

# iqfoc_add_image(name SOURCES... ): one ELF for the emulator.
function(iqfoc_add_image name)
    add_executable(${name} ${ARGN})
    set_target_properties(${name} PROPERTIES SUFFIX .elf)
    target_link_libraries(${name} PRIVATE iqfoc port)
endfunction()

add_subdirectory(${PROJECT_SOURCE_DIR}/bench ${PROJECT_BINARY_DIR}/bench)
if(UNITY_DIR)
    add_subdirectory(${PROJECT_SOURCE_DIR}/tests/target ${PROJECT_BINARY_DIR}/tests/target)
endif()

# The image that `iqfoc simulate --target` runs, at the top of the build folder, where the program looks for it.
add_library(pil_board STATIC ${CMAKE_CURRENT_LIST_DIR}/pil_main.c ${CMAKE_CURRENT_LIST_DIR}/pil_recorder.c
            ${CMAKE_CURRENT_LIST_DIR}/pil_wire.c ${CMAKE_CURRENT_LIST_DIR}/tuned_firmware.c)
target_link_libraries(pil_board PUBLIC iqfoc port)
iqfoc_add_image(iqfoc_pil ${CMAKE_CURRENT_LIST_DIR}/pil_reference.c)
target_link_libraries(iqfoc_pil PRIVATE pil_board)
set_target_properties(iqfoc_pil PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
