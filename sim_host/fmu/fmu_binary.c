/* The bytes of the shared library, taken in by the assembler (fmu_binary.h). FMU_LIBRARY_FILE is its path. */
#include "fmu_binary.h"

#include <stdint.h>

__asm__(".pushsection .rodata\n"
        ".global fmu_library\n"
        ".global fmu_library_end\n"
        ".balign 16\n"
        "fmu_library:\n"
        ".incbin \"" FMU_LIBRARY_FILE "\"\n"
        "fmu_library_end:\n"
        ".byte 0\n"
        ".popsection\n");

extern const unsigned char fmu_library_end[];

size_t fmu_library_size(void)
{
    return (size_t)((uintptr_t)fmu_library_end - (uintptr_t)fmu_library);
}
