/* Whose references the image for processor in the loop follows: the simulator's, or its own in its place. */
#ifndef PORT_EMULATED_PIL_REFERENCE_H
#define PORT_EMULATED_PIL_REFERENCE_H

#include "iqfoc/vector.h"

/* Once a control cycle. asked: the simulator's. */
iqfoc_dq_t pil_reference(iqfoc_dq_t asked);

#endif
