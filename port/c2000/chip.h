/*
 * The two families, and where their peripherals are. The memory maps agree in what is used here.
 */
#ifndef PORT_C2000_CHIP_H
#define PORT_C2000_CHIP_H

#include "c2000.h"

/* 100 MHz, and the time base at the same clock. */
#define C2000_F28004X                                                                                        \
    {                                                                                                        \
        .clock_hz = UINT32_C(100000000), .clocks_per_tick = 1, .pll_multiplier = 20, .adc_prescale = 2,      \
        .adc_window = 10, .flash_waits = 4, .flash_banks = 2, .has_epwm_divider = false,                     \
        .reference_on_chip = true                                                                            \
    }

/*
 * 200 MHz, and the time base at half of it, its greatest clock. At this ratio a write of TZFRC or TZCLR may
 * be missed (errata SPRZ412): the port reads the flag back and repeats the write.
 */
#define C2000_F2837XD                                                                                        \
    {                                                                                                        \
        .clock_hz = UINT32_C(200000000), .clocks_per_tick = 2, .pll_multiplier = 40, .adc_prescale = 6,      \
        .adc_window = 20, .flash_waits = 3, .flash_banks = 1, .has_epwm_divider = true,                      \
        .reference_on_chip = false                                                                           \
    }

/*
 * The same chip at 100 MHz, core and time base alike: what TI advises for software that writes these
 * registers.
 */
#define C2000_F2837XD_100_MHZ                                                                                \
    {                                                                                                        \
        .clock_hz = UINT32_C(100000000), .clocks_per_tick = 1, .pll_multiplier = 20, .adc_prescale = 2,      \
        .adc_window = 10, .flash_waits = 1, .flash_banks = 1, .has_epwm_divider = true,                      \
        .reference_on_chip = false                                                                           \
    }

#define C2000_REGISTERS_(address) ((c2000_reg_t *)(address))
#define C2000_CHIP(family_)                                                                                  \
    {                                                                                                        \
        .family = &(family_),                                                                                \
        .epwm = {C2000_REGISTERS_(0x4000), C2000_REGISTERS_(0x4100), C2000_REGISTERS_(0x4200)},              \
        .adc = {C2000_REGISTERS_(0x7400), C2000_REGISTERS_(0x7480)},                                         \
        .adc_result = {C2000_REGISTERS_(0x0B00), C2000_REGISTERS_(0x0B20)},                                  \
        .eqep = C2000_REGISTERS_(0x5100), .timer = C2000_REGISTERS_(0x0C08),                                 \
        .clk = C2000_REGISTERS_(0x5D200), .sys = C2000_REGISTERS_(0x5D300),                                  \
        .watchdog = C2000_REGISTERS_(0x7000), .flash = C2000_REGISTERS_(0x5F800),                            \
        .analog = C2000_REGISTERS_(0x5D700), .gpio = C2000_REGISTERS_(0x7C00),                               \
        .input_xbar = C2000_REGISTERS_(0x7900), .pie = C2000_REGISTERS_(0x0CE0),                             \
        .pie_vectors = C2000_REGISTERS_(0x0D00)                                                              \
    }

#endif
