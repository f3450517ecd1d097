/* The simulator's references (pil_reference.h). */
#include "pil_reference.h"

iqfoc_dq_t pil_reference(iqfoc_dq_t asked)
{
    return asked;
}
