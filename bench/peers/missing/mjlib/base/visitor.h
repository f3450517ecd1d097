/* In place of mjlib's header of this name: what the counted functions do not use, so that it compiles. */
#pragma once

#define MJ_NVP(x) (x)
