/*
 * ePWM1, 2, 3 of the F28004x and F2837xD as the carrier (board.h).
 */
#include "board.h"
#include "hal_c2000_inline.h"

/* Set on the way up, clear on the way down: high around the period. */
static void leg_start(c2000_reg_t *epwm, uint32_t half_ticks, uint32_t dead_ticks)
{
    c2000_write(epwm + EPWM_TZSEL, TZSEL_ONE_SHOT);
    c2000_write(epwm + EPWM_TZCTL, TZCTL_BOTH_LOW);
    (void)c2000_trip(epwm);
    c2000_write(epwm + EPWM_TBCTL, TBCTL_FREE | TBCTL_IMMEDIATE | TBCTL_UP_DOWN);
    c2000_write(epwm + EPWM_TBCTR, 0);
    c2000_write(epwm + EPWM_TBPRD, (uint16_t)half_ticks);
    /* At once, for the first period; from then on a value waits in the shadow register. */
    c2000_write(epwm + EPWM_CMPCTL, CMPCTL_A_IMMEDIATE);
    c2000_write(epwm + EPWM_CMPA, (uint16_t)half_ticks); /* duty 0: low sides only */
    c2000_write(epwm + EPWM_CMPCTL, CMPCTL_A_AT_ZERO);
    c2000_write(epwm + EPWM_GLDCFG, GLDCFG_CMPA);
    c2000_write(epwm + EPWM_GLDCTL, GLDCTL_ONCE_AT_ZERO);
    c2000_write_long(epwm + EPWM_XLINK, c2000_read_long(epwm + EPWM_XLINK) & ~XLINK_GLDCTL2);
    c2000_write(epwm + EPWM_AQCTLA, AQCTL_SET_UP | AQCTL_CLEAR_DOWN);
    c2000_write(epwm + EPWM_DBRED, (uint16_t)dead_ticks);
    c2000_write(epwm + EPWM_DBFED, (uint16_t)dead_ticks);
    c2000_write(epwm + EPWM_DBCTL, DBCTL_COMPLEMENTARY);
}

c2000_error_t c2000_carrier_start(const c2000_chip_t *chip, uint32_t half_ticks, uint32_t dead_time_ns)
{
    const uint32_t dead_ticks = dead_time_ns / 10 + (dead_time_ns % 10 != 0 ? 1 : 0);
    if (half_ticks < 100 || half_ticks > UINT32_C(65534)) {
        return C2000_ERROR_CARRIER;
    }
    if (dead_ticks > DBRED_MAX) {
        return C2000_ERROR_DEAD_TIME;
    }
    c2000_unprotect();
    c2000_write_long(chip->sys + SYS_PCLKCR0, c2000_read_long(chip->sys + SYS_PCLKCR0) & ~PCLKCR0_TBCLKSYNC);
    c2000_write_long(chip->sys + SYS_PCLKCR2, c2000_read_long(chip->sys + SYS_PCLKCR2) | PCLKCR2_EPWM_1_2_3);
    (void)c2000_read_long(chip->sys + SYS_PCLKCR2); /* the clock is there a few clocks later */
    (void)c2000_read_long(chip->sys + SYS_PCLKCR2);
    for (uint32_t leg = 0; leg < 3; leg++) {
        leg_start(chip->epwm[leg], half_ticks, dead_ticks);
    }
    c2000_protect();
    c2000_write(chip->epwm[0] + EPWM_ETPS, ETPS_EVERY_EVENT);
    c2000_write(chip->epwm[0] + EPWM_ETSEL, ETSEL_A_ZERO | ETSEL_B_PERIOD);
    return C2000_OK;
}

/* One clock for the three time bases: they start at 0 together and stay together. */
void c2000_run(const c2000_chip_t *chip)
{
    c2000_unprotect();
    c2000_write_long(chip->sys + SYS_PCLKCR0, c2000_read_long(chip->sys + SYS_PCLKCR0) | PCLKCR0_TBCLKSYNC);
    c2000_protect();
}
