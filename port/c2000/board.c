/*
 * Clock, converters, encoder, pins and interrupts of the F28004x and F2837xD (board.h).
 */
#include "board.h"

/* Reads of a register before a part that does not answer is given up: more than 1 ms at 200 MHz. */
#define PATIENCE UINT32_C(100000)

/* A first lock of the PLL may fail: five are made (F2837xD errata, SPRZ412). */
#define PLL_LOCKS 5

/*
 * Reads that pass 60 clocks of the oscillator, 6 us, at 200 MHz; and 500 us. A read takes two clocks or more.
 */
#define SETTLE_READS   UINT32_C(600)
#define POWER_UP_READS UINT32_C(50000)

C2000_RAM_FUNCTION static void pass(c2000_reg_t *reg, uint32_t reads)
{
    for (uint32_t k = 0; k < reads; k++) {
        (void)c2000_read(reg);
    }
}

C2000_RAM_FUNCTION static void replace(c2000_reg_t *reg, uint16_t mask, uint16_t bits)
{
    c2000_write(reg, (uint16_t)((c2000_read(reg) & (uint16_t)~mask) | bits));
}

C2000_RAM_FUNCTION static void replace_long(c2000_reg_t *reg, uint32_t mask, uint32_t bits)
{
    c2000_write_long(reg, (c2000_read_long(reg) & ~mask) | bits);
}

C2000_RAM_FUNCTION static bool locks(c2000_reg_t *clk)
{
    for (uint32_t k = 0; k < PATIENCE; k++) {
        if ((c2000_read(clk + CLK_PLLSTS) & PLLSTS_LOCKED) != 0) {
            return true;
        }
    }
    return false;
}

/*
 * With the PLL off and bypassed the core runs at the oscillator's 10 MHz. The divider is one step larger at
 * the switch, as the supply wants the current to rise in steps (system control, "PLL initialization").
 */
C2000_RAM_FUNCTION c2000_error_t c2000_clock_start(const c2000_chip_t *chip)
{
    const c2000_family_t *family = chip->family;
    c2000_reg_t *clk = chip->clk;
    bool locked = false;
    c2000_unprotect();
    c2000_write(chip->watchdog + WD_WDCR, WDCR_OFF);
    replace_long(chip->flash + FLASH_FBFALLBACK, 0, FBFALLBACK_ACTIVE(family->flash_banks));
    replace_long(chip->flash + FLASH_FPAC1, 0, FPAC1_ACTIVE);
    replace_long(chip->flash + FLASH_INTF_CTRL, INTF_CTRL_PREFETCH_CACHE, 0);
    replace_long(chip->flash + FLASH_FRDCNTL, FRDCNTL_MASK, FRDCNTL_WAITS(family->flash_waits));
    replace_long(chip->flash + FLASH_INTF_CTRL, 0, INTF_CTRL_PREFETCH_CACHE);
    replace(clk + CLK_SRCCTL1, SRCCTL1_MASK, 0);
    replace(clk + CLK_PLLCTL1, PLLCTL1_USED, 0);
    pass(clk + CLK_PLLCTL1, SETTLE_READS);
    for (uint32_t k = 0; k < PLL_LOCKS; k++) {
        replace(clk + CLK_PLLCTL1, PLLCTL1_ON, 0);
        pass(clk + CLK_PLLCTL1, SETTLE_READS);
        c2000_write_long(clk + CLK_PLLMULT, family->pll_multiplier); /* and switches the PLL on */
        locked = locks(clk);
    }
    if (locked) {
        c2000_write(clk + CLK_SYSDIVSEL, 2);
        replace(clk + CLK_PLLCTL1, 0, PLLCTL1_USED);
        pass(clk + CLK_PLLCTL1, SETTLE_READS);
        c2000_write(clk + CLK_SYSDIVSEL, 1);
        if (family->has_epwm_divider) {
            replace(clk + CLK_PERDIVSEL, PERDIVSEL_EPWM, (uint16_t)(family->clocks_per_tick - 1));
        }
    }
    c2000_protect();
    return locked ? C2000_OK : C2000_ERROR_CLOCK;
}

c2000_error_t c2000_encoder_start(const c2000_chip_t *chip, uint32_t counts_per_turn)
{
    if (counts_per_turn < 4 || counts_per_turn > UINT32_C(65536)) {
        return C2000_ERROR_ENCODER;
    }
    c2000_unprotect();
    replace_long(chip->sys + SYS_PCLKCR4, 0, PCLKCR4_EQEP1);
    replace_long(chip->sys + SYS_PCLKCR0, 0, PCLKCR0_TIMER1);
    c2000_protect();
    pass(chip->sys + SYS_PCLKCR0, 5); /* the clock is there a few clocks later */
    c2000_write(chip->eqep + EQEP_QEPCTL, 0);
    c2000_write(chip->eqep + EQEP_QDECCTL, QDECCTL_QUADRATURE);
    c2000_write_long(chip->eqep + EQEP_QPOSMAX, counts_per_turn - 1);
    c2000_write_long(chip->eqep + EQEP_QPOSCNT, 0);
    c2000_write(chip->eqep + EQEP_QEPCTL, QEPCTL_RUN);
    c2000_write(chip->eqep + EQEP_QCLR, QFLG_PHASE);
    c2000_write(chip->timer + TIMER_TCR, TCR_STOP);
    c2000_write_long(chip->timer + TIMER_PRD, UINT32_MAX);
    c2000_write(chip->timer + TIMER_TPR, 0);
    c2000_write(chip->timer + TIMER_TPRH, 0);
    c2000_write(chip->timer + TIMER_TCR, TCR_RELOAD | TCR_FREE);
    return C2000_OK;
}

static void conversion(const c2000_chip_t *chip, uint32_t converter, uint32_t number, uint32_t trigger,
                       uint16_t channel)
{
    c2000_write_long(chip->adc[converter] + ADC_SOCCTL(number),
                     SOC_TRIGGER(trigger) | SOC_CHANNEL(channel) | SOC_WINDOW(chip->family->adc_window));
}

/*
 * SOC0 and SOC1 at the valley, SOC2 and SOC3 at the peak: each has a result of its own, which the other
 * instant leaves alone.
 */
c2000_error_t c2000_converters_start(const c2000_chip_t *chip, const c2000_channels_t *channels)
{
    if (channels->i_a > 15 || channels->i_b > 15 || channels->u_dc > 15) {
        return C2000_ERROR_CHANNEL;
    }
    c2000_unprotect();
    replace_long(chip->sys + SYS_PCLKCR13, 0, UINT32_C(3));
    pass(chip->sys + SYS_PCLKCR13, 5);
    if (chip->family->reference_on_chip) {
        replace(chip->analog + ANALOG_ANAREFCTL, ANAREFCTL_ALL, 0);
    }
    for (uint32_t x = 0; x < 2; x++) {
        c2000_write(chip->adc[x] + ADC_CTL2, chip->family->adc_prescale); /* 12 bits, single-ended */
        c2000_write(chip->adc[x] + ADC_CTL1, CTL1_INT_AT_END | CTL1_POWERED);
    }
    conversion(chip, 0, 0, SOC_BY_EPWM1_A, channels->i_a);
    conversion(chip, 0, 1, SOC_BY_EPWM1_A, channels->u_dc);
    conversion(chip, 0, 2, SOC_BY_EPWM1_B, channels->i_a);
    conversion(chip, 0, 3, SOC_BY_EPWM1_B, channels->u_dc);
    conversion(chip, 1, 0, SOC_BY_EPWM1_A, channels->i_b);
    conversion(chip, 1, 2, SOC_BY_EPWM1_B, channels->i_b);
    c2000_write(chip->adc[0] + ADC_INTSEL1N2, INTSEL_VALLEY_PEAK);
    c2000_protect();
    return C2000_OK;
}

/* One bit of a register with one bit a pin spread to two bits a pin. */
static uint32_t at(uint32_t pin, uint32_t two_bits)
{
    return two_bits << (2 * pin);
}

void c2000_pins_start(const c2000_chip_t *chip)
{
    c2000_reg_t *gpio = chip->gpio;
    const uint32_t encoder = at(10, 1) | at(11, 1);
    const uint32_t gates = at(0, 1) | at(1, 1) | at(2, 1) | at(3, 1) | at(4, 1) | at(5, 1);
    pass(chip->adc[0] + ADC_CTL1, POWER_UP_READS);
    c2000_unprotect();
    /*
     * The break line: an input that needs no clock; its pull-up is off, so that the board's pull-down makes a
     * torn line a break.
     */
    replace_long(gpio + GPIO_GPAQSEL1, 0, at(12, GPIO_ASYNCHRONOUS));
    replace_long(gpio + GPIO_GPAPUD, 0, (UINT32_C(1) << 12) | UINT32_C(0x3F));
    c2000_write(chip->input_xbar + XBAR_INPUT1, 12);
    /* The upper half of a pin's function before the lower: no other function in between. */
    replace_long(gpio + GPIO_GPAGMUX1, encoder * 3 | gates * 3, encoder);
    replace_long(gpio + GPIO_GPAMUX1, encoder * 3 | gates * 3, encoder | gates);
    c2000_protect();
}

void c2000_interrupts_start(const c2000_chip_t *chip, uint32_t valley_handler, uint32_t peak_handler)
{
    c2000_unprotect();
    c2000_write_long(chip->pie_vectors + PIE_VECTOR_ADCA1, valley_handler);
    c2000_write_long(chip->pie_vectors + PIE_VECTOR_ADCA2, peak_handler);
    c2000_protect();
    c2000_write(chip->pie + PIE_IER(PIE_GROUP_VALLEY), PIE_IER_ADCA1);
    c2000_write(chip->pie + PIE_IER(PIE_GROUP_PEAK), PIE_IER_ADCA2);
    c2000_write(chip->pie + PIE_CTRL, PIE_ON);
    c2000_write(chip->pie + PIE_ACK, PIE_GROUP(PIE_GROUP_VALLEY) | PIE_GROUP(PIE_GROUP_PEAK));
}
