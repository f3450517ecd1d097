/* Turns to radians, in fixed point. */
#ifndef IQFOC_SRC_ANGLE_H
#define IQFOC_SRC_ANGLE_H

#include <stdint.h>

#define TWO_PI_Q28 INT32_C(1686629713) /* 2 pi: 1686629713.07 */

#endif
