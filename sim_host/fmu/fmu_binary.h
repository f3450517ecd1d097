/* The FMU's shared library, which the program carries within itself: wherever the program is, an FMU can be made. */
#ifndef SIM_HOST_FMU_FMU_BINARY_H
#define SIM_HOST_FMU_FMU_BINARY_H

#include <stddef.h>

extern const unsigned char fmu_library[];

size_t fmu_library_size(void);

#endif
