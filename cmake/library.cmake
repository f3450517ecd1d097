# What the library `iqfoc` is held to, on every target: C99 and freestanding, the host included, so that nothing hosted
# slips in unseen.
function(iqfoc_library_options target)
    set_target_properties(${target} PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
    target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR}/include)
    target_compile_options(${target} PRIVATE -ffreestanding)
    if(IQFOC_SANITIZE)
        # Wrap-around of unsigned numbers and lossy conversions are defined in C, but in fixed-point code they are
        # mostly mistakes: the library computes what is meant to wrap so that it does not trip this.
        target_compile_options(${target} PRIVATE -fsanitize=integer)
    endif()
endfunction()
