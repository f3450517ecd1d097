/*
 * Registers of the F28004x and the F2837xD that this port uses, and the accesses to them.
 *
 * A register is a base and an offset, both in words of 16 bits, as the C28x addresses them and as the technical
 * reference manuals count (SPRUI33 for the F28004x, SPRUHM8 for the F2837xD). The offsets and bits below are
 * the same in both families except where a comment names one. A register of 32 bits has its low half at the
 * lower address. Names in comments are those of the manuals' bit fields.
 */
#ifndef PORT_C2000_H
#define PORT_C2000_H

#include <stdbool.h>
#include <stdint.h>

/* A word of a register. */
typedef volatile uint16_t c2000_reg_t;

/* ---- ePWM, type 4: time base ---- */
#define EPWM_TBCTL      0x00
#define EPWM_TBCTR      0x04
#define EPWM_TBSTS      0x05
#define EPWM_TBPRD      0x63
#define TBCTL_UP_DOWN   UINT16_C(0x0002) /* CTRMODE = 10; HSPCLKDIV = CLKDIV = 0: the clock itself */
#define TBCTL_IMMEDIATE UINT16_C(0x0008) /* PRDLD: TBPRD without shadow */
#define TBCTL_FREE                                                                                           \
    UINT16_C(0x8000) /* FREE_SOFT = 10: goes on when a debugger stops the core; TZ6 trips then */
#define TBSTS_COUNTS_UP UINT16_C(0x0001)

/* ---- Compare and action qualifier ---- */
#define EPWM_CMPCTL        0x08
#define EPWM_CMPA          0x6B /* the upper word of CMPA; the lower, 0x6A, is the high-resolution part */
#define EPWM_AQCTLA        0x40
#define CMPCTL_A_IMMEDIATE UINT16_C(0x0010) /* SHDWAMODE = 1 */
#define CMPCTL_A_AT_ZERO   UINT16_C(0x0000) /* SHDWAMODE = 0, LOADAMODE = 00 */
#define AQCTL_SET_UP       UINT16_C(0x0020) /* CAU = 10 */
#define AQCTL_CLEAR_DOWN   UINT16_C(0x0040) /* CAD = 01 */

/* ---- Load of the shadow registers of several modules at once ---- */
#define EPWM_GLDCTL         0x34
#define EPWM_GLDCFG         0x35
#define EPWM_XLINK          0x38 /* 32 bits */
#define EPWM_GLDCTL2        0x74
#define GLDCTL_ONCE_AT_ZERO UINT16_C(0x0021) /* GLD, OSHTMODE; GLDMODE = 0000: at zero */
#define GLDCFG_CMPA         UINT16_C(0x0002)
#define XLINK_GLDCTL2       UINT32_C(0xF0000000) /* 0: linked to ePWM1 */
#define GLDCTL2_LOAD        UINT16_C(0x0001)     /* OSHTLD */

/* ---- Dead band, counted in the time base's clock ---- */
#define EPWM_DBCTL 0x0C
#define EPWM_DBRED 0x51
#define EPWM_DBFED 0x53
#define DBCTL_COMPLEMENTARY                                                                                  \
    UINT16_C(0x000B) /* IN_MODE = 00: from A; POLSEL = 10: B inverted; OUT_MODE = 11: both delayed */
#define DBRED_MAX UINT32_C(0x3FFF)

/* ---- Trip zone ---- */
#define EPWM_TZSEL    0x80
#define EPWM_TZCTL    0x84
#define EPWM_TZFLG    0x93
#define EPWM_TZOSTFLG 0x95
#define EPWM_TZCLR    0x97
#define EPWM_TZOSTCLR 0x99
#define EPWM_TZFRC    0x9B
#define TZSEL_ONE_SHOT                                                                                       \
    UINT16_C(0x3100) /* OSHT1: the pin; OSHT5: no clock; OSHT6: a debugger stops the core */
#define TZCTL_BOTH_LOW UINT16_C(0x000A) /* TZA = TZB = 10 */
#define TZ_OST         UINT16_C(0x0004) /* in TZFLG, TZCLR, TZFRC */
#define TZOST_SOURCES  UINT16_C(0x0031) /* of TZSEL_ONE_SHOT, in TZOSTFLG and TZOSTCLR */

/* ---- Event trigger ---- */
#define EPWM_ETSEL       0xA4
#define EPWM_ETPS        0xA6
#define ETSEL_A_ZERO     UINT16_C(0x0900) /* SOCAEN, SOCASEL = 001 */
#define ETSEL_B_PERIOD   UINT16_C(0xA000) /* SOCBEN, SOCBSEL = 010 */
#define ETPS_EVERY_EVENT UINT16_C(0x1100) /* SOCAPRD = SOCBPRD = 01 */

/* ---- ADC ---- */
#define ADC_CTL1        0x00
#define ADC_CTL2        0x01
#define ADC_INTFLGCLR   0x04
#define ADC_INTSEL1N2   0x07
#define ADC_SOCCTL(n)   (0x10 + 2 * (n)) /* 32 bits */
#define ADC_RESULT(n)   (n)              /* from the base of the results */
#define CTL1_INT_AT_END UINT16_C(0x0004) /* INTPULSEPOS: when the result is there */
#define CTL1_POWERED    UINT16_C(0x0080) /* ADCPWDNZ */
#define INTFLG_1        UINT16_C(0x0001)
#define INTFLG_2        UINT16_C(0x0002)
/*
 * ADCINT1 after SOC1, ADCINT2 after SOC3; INTxCONT: a pulse for each, even if the flag was not cleared in
 * between.
 */
#define INTSEL_VALLEY_PEAK UINT16_C(0x6361)
#define SOC_TRIGGER(t)     ((uint32_t)(t) << 20)
#define SOC_CHANNEL(c)     ((uint32_t)(c) << 15)
#define SOC_WINDOW(clocks) ((uint32_t)(clocks)-1) /* ACQPS */
#define SOC_BY_EPWM1_A     5
#define SOC_BY_EPWM1_B     6

/* ---- eQEP ---- */
#define EQEP_QPOSCNT       0x00 /* 32 bits */
#define EQEP_QPOSMAX       0x04 /* 32 bits */
#define EQEP_QDECCTL       0x14
#define EQEP_QEPCTL        0x15
#define EQEP_QFLG          0x19
#define EQEP_QCLR          0x1A
#define QFLG_PHASE         UINT16_C(0x0004) /* PHE: both signals changed at once */
#define QEPCTL_RUN         UINT16_C(0x9008) /* FREE_SOFT = 10, PCRM = 01: to 0 after QPOSMAX; QPEN */
#define QDECCTL_QUADRATURE UINT16_C(0)      /* all four edges of A and B */

/* ---- CPU timer 1: counts down from PRD ---- */
#define TIMER_TIM  0x00 /* 32 bits */
#define TIMER_PRD  0x02 /* 32 bits */
#define TIMER_TCR  0x04
#define TIMER_TPR  0x06
#define TIMER_TPRH 0x07
#define TCR_RELOAD UINT16_C(0x0020) /* TRB; TSS = 0: runs */
#define TCR_FREE   UINT16_C(0x0800) /* FREE: goes on when a debugger stops the core */
#define TCR_STOP   UINT16_C(0x0010) /* TSS */

/* ---- System control: clock configuration ---- */
#define CLK_SRCCTL1    0x08
#define CLK_PLLCTL1    0x0E
#define CLK_PLLMULT    0x14 /* 32 bits */
#define CLK_PLLSTS     0x16
#define CLK_SYSDIVSEL  0x22
#define CLK_PERDIVSEL  0x26             /* F2837xD */
#define SRCCTL1_MASK   UINT16_C(0x0003) /* 00: INTOSC2, 10 MHz */
#define PLLCTL1_ON     UINT16_C(0x0001)
#define PLLCTL1_USED   UINT16_C(0x0002)
#define PLLSTS_LOCKED  UINT16_C(0x0001)
#define PERDIVSEL_EPWM UINT16_C(0x0003)

/* ---- System control: clocks of the peripherals ---- */
#define SYS_PCLKCR0        0x22 /* 32 bits, as all of them */
#define SYS_PCLKCR2        0x26
#define SYS_PCLKCR4        0x2A
#define SYS_PCLKCR13       0x3C
#define PCLKCR0_TIMER1     UINT32_C(0x00000010)
#define PCLKCR0_TBCLKSYNC  UINT32_C(0x00040000)
#define PCLKCR2_EPWM_1_2_3 UINT32_C(0x00000007)
#define PCLKCR4_EQEP1      UINT32_C(0x00000001)

/* ---- Watchdog, flash, analog subsystem ---- */
#define WD_WDCR                  0x29
#define WDCR_OFF                 UINT16_C(0x0068)                     /* WDDIS, WDCHK = 101 */
#define FLASH_FRDCNTL            0x00                                 /* 32 bits */
#define FLASH_FBFALLBACK         0x20                                 /* 32 bits */
#define FLASH_FPAC1              0x24                                 /* 32 bits */
#define FBFALLBACK_ACTIVE(banks) ((UINT32_C(1) << (2 * (banks))) - 1) /* BNKPWR0, BNKPWR1 = 11: no sleep */
#define FPAC1_ACTIVE             UINT32_C(0x00000001)                 /* PMPPWR */
#define FLASH_INTF_CTRL          0x180                                /* 32 bits */
#define FRDCNTL_WAITS(n)         ((uint32_t)(n) << 8)
#define FRDCNTL_MASK             UINT32_C(0x00000F00)
#define INTF_CTRL_PREFETCH_CACHE UINT32_C(0x00000003)
#define ANALOG_ANAREFCTL         0x68             /* F28004x */
#define ANAREFCTL_ALL            UINT16_C(0x0707) /* 0: internal reference, 3.3 V range, for A, B, C */

/* ---- GPIO 0 to 15 and the input X-BAR ---- */
#define GPIO_GPAQSEL1     0x02 /* 32 bits, as all of them: two bits a pin */
#define GPIO_GPAMUX1      0x06
#define GPIO_GPADIR       0x0A /* one bit a pin */
#define GPIO_GPAPUD       0x0C /* one bit a pin: no pull-up */
#define GPIO_GPAGMUX1     0x20
#define GPIO_ASYNCHRONOUS UINT32_C(3) /* of GPAQSEL1 */
#define XBAR_INPUT1       0x00        /* number of the pin that is TZ1 */

/* ---- Interrupts ---- */
#define PIE_CTRL         0x00
#define PIE_ACK          0x01
#define PIE_IER(group)   (0x02 * (group))
#define PIE_VECTOR_ADCA1 0x40 /* from the base of the table, 32 bits: 1.1, number 32 */
#define PIE_VECTOR_ADCA2 0xD2 /* 10.2, number 105 */
#define PIE_ON           UINT16_C(0x0001)
#define PIE_GROUP(g)     ((uint16_t)(UINT16_C(1) << ((g)-1)))
#define PIE_GROUP_VALLEY 1
#define PIE_GROUP_PEAK   10
#define PIE_IER_ADCA1    UINT16_C(0x0001) /* INTx1 */
#define PIE_IER_ADCA2    UINT16_C(0x0002) /* INTx2 */

/* In what the families differ. */
typedef struct c2000_family {
    uint32_t clock_hz;        /* of the core, and of the timer that stamps samples */
    uint32_t clocks_per_tick; /* of the core for one of the time base, 1 or 2: a tick is 10 ns in both */
    uint32_t pll_multiplier;  /* of 10 MHz, before the divider by 2 */
    uint16_t adc_prescale;    /* ADCCTL2: 50 MHz */
    uint32_t adc_window;      /* core clocks: 100 ns */
    uint32_t flash_waits;
    uint32_t flash_banks;
    bool has_epwm_divider;  /* PERCLKDIVSEL: clocks_per_tick */
    bool reference_on_chip; /* ANAREFCTL */
} c2000_family_t;

/* Where the peripherals are; a test puts a bank of memory in their place. */
typedef struct c2000_chip {
    const c2000_family_t *family;
    c2000_reg_t *epwm[3]; /* legs A, B, C */
    c2000_reg_t *adc[2];  /* A and B */
    c2000_reg_t *adc_result[2];
    c2000_reg_t *eqep;
    c2000_reg_t *timer; /* CPU timer 1 */
    c2000_reg_t *clk;
    c2000_reg_t *sys;
    c2000_reg_t *watchdog;
    c2000_reg_t *flash;
    c2000_reg_t *analog;
    c2000_reg_t *gpio;
    c2000_reg_t *input_xbar;
    c2000_reg_t *pie;
    c2000_reg_t *pie_vectors;
} c2000_chip_t;

/* Ticks of the time base a second, in both families. */
#define C2000_TICK_HZ UINT32_C(100000000)

/*
 * Every access goes through these, so that a test can watch the order. Registers that the core protects are
 * written between c2000_unprotect and c2000_protect.
 */
#ifdef C2000_BUS_HEADER
#include C2000_BUS_HEADER
#else
static inline uint16_t c2000_read(c2000_reg_t *reg)
{
    return *reg;
}

static inline void c2000_write(c2000_reg_t *reg, uint16_t value)
{
    *reg = value;
}

/* One access of 32 bits: the halves of a counter belong together. */
static inline uint32_t c2000_read_long(c2000_reg_t *reg)
{
    return *(volatile uint32_t *)reg;
}

static inline void c2000_write_long(c2000_reg_t *reg, uint32_t value)
{
    *(volatile uint32_t *)reg = value;
}

static inline void c2000_unprotect(void)
{
    __asm(" EALLOW");
}

static inline void c2000_protect(void)
{
    __asm(" EDIS");
}
#endif

#endif
