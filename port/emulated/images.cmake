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
