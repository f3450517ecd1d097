/* What the converters of the stand-in drives give (port/emulated/small_drive.h). */
#include "small_drive.h"

#include "iqfoc/transform.h"

/* One step of a 12-bit converter over +-4 per unit. */
#define CONVERTER_STEP (IQ24_ONE / 512)

static iq24_t converted(iq24_t i)
{
    return iq24_asr32(i + CONVERTER_STEP / 2, 15) * CONVERTER_STEP;
}

iqfoc_sample_t small_drive_sample(const small_drive_t *drive)
{
    const iqfoc_abc_t i = iqfoc_clarke_inverse(drive->i);
    const iqfoc_sample_t sample = {
        .i = {converted(i.a), converted(i.b), converted(i.c)},
        .theta = drive->theta,
        .speed = drive->speed,
        .u_dc = IQ24_ONE,
    };
    return sample;
}
