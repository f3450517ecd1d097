# The library target `iqfoc`: its sources are listed in src/, what it is held to stands here.
# C99 and freestanding on every target, the host included, so that nothing hosted slips in unseen.
iqfoc_add_folder(src)
if(NOT TARGET iqfoc)
    message(WARNING "src/ brings no library yet")
    return()
endif()

set_target_properties(iqfoc PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
target_include_directories(iqfoc PUBLIC ${PROJECT_SOURCE_DIR}/include)
target_compile_options(iqfoc PRIVATE -ffreestanding)

if(IQFOC_SANITIZE)
    # Wrap-around of unsigned numbers and lossy conversions are defined in C, but in fixed-point code they are
    # mostly mistakes: where they are meant, the function says so by an attribute.
    target_compile_options(iqfoc PRIVATE -fsanitize=integer)
endif()
