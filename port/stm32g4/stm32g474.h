/*
 * Registers of the STM32G474 that this port uses.
 *
 * The numbers in the comments are sections of the reference manual RM0440, revision 9. Those of the
 * advanced-control timers (29) were compared with the manual register by register; for the other peripherals
 * the chapter's register section is given, and offsets and bits are those that the manual has had since
 * revision 1. The mapping of pins to alternate functions is the data sheet's (DS12288, table "Alternate
 * function"); check it against your package.
 */
#ifndef PORT_STM32G474_H
#define PORT_STM32G474_H

#include <stdint.h>

/* A register, and room between registers. */
typedef volatile uint32_t stm32g4_reg_t;

/* ---- 3.7 FLASH ---- */
typedef struct stm32g4_flash {
    stm32g4_reg_t ACR;
} stm32g4_flash_t;
#define FLASH_ACR_LATENCY_MASK UINT32_C(0xF)
#define FLASH_ACR_LATENCY_4    UINT32_C(4) /* 3.3.3: 136 to 170 MHz in range 1 boost mode */
#define FLASH_ACR_PRFTEN       (UINT32_C(1) << 8)
#define FLASH_ACR_ICEN         (UINT32_C(1) << 9)
#define FLASH_ACR_DCEN         (UINT32_C(1) << 10)

/* ---- 6.4 PWR ---- */
typedef struct stm32g4_pwr {
    stm32g4_reg_t CR1;
    stm32g4_reg_t gap_04[31];
    stm32g4_reg_t CR5; /* 0x80 */
} stm32g4_pwr_t;
#define PWR_CR5_R1MODE (UINT32_C(1) << 8) /* 0: boost, needed above 150 MHz */

/* ---- 7.4 RCC ---- */
typedef struct stm32g4_rcc {
    stm32g4_reg_t CR;         /* 0x00 */
    stm32g4_reg_t ICSCR;      /* 0x04 */
    stm32g4_reg_t CFGR;       /* 0x08 */
    stm32g4_reg_t PLLCFGR;    /* 0x0C */
    stm32g4_reg_t gap_10[14]; /* 0x10 */
    stm32g4_reg_t AHB1ENR;    /* 0x48 */
    stm32g4_reg_t AHB2ENR;    /* 0x4C */
    stm32g4_reg_t AHB3ENR;    /* 0x50 */
    stm32g4_reg_t gap_54;     /* 0x54 */
    stm32g4_reg_t APB1ENR1;   /* 0x58 */
    stm32g4_reg_t APB1ENR2;   /* 0x5C */
    stm32g4_reg_t APB2ENR;    /* 0x60 */
} stm32g4_rcc_t;
#define RCC_CR_HSION          (UINT32_C(1) << 8)
#define RCC_CR_HSIRDY         (UINT32_C(1) << 10)
#define RCC_CR_PLLON          (UINT32_C(1) << 24)
#define RCC_CR_PLLRDY         (UINT32_C(1) << 25)
#define RCC_CFGR_SW_MASK      UINT32_C(0x3)
#define RCC_CFGR_SW_PLL       UINT32_C(0x3)
#define RCC_CFGR_SWS_MASK     UINT32_C(0xC)
#define RCC_CFGR_SWS_PLL      UINT32_C(0xC)
#define RCC_CFGR_HPRE_MASK    UINT32_C(0xF0)
#define RCC_CFGR_HPRE_DIV_2   UINT32_C(0x80)
#define RCC_PLLCFGR_SRC_HSI   UINT32_C(2)
#define RCC_PLLCFGR_M(m)      (((uint32_t)(m)-1) << 4)
#define RCC_PLLCFGR_N(n)      ((uint32_t)(n) << 8)
#define RCC_PLLCFGR_REN       (UINT32_C(1) << 24)
#define RCC_PLLCFGR_R_DIV_2   UINT32_C(0)
#define RCC_AHB1ENR_DMA1EN    (UINT32_C(1) << 0)
#define RCC_AHB1ENR_DMAMUX1EN (UINT32_C(1) << 2)
#define RCC_AHB2ENR_GPIOAEN   (UINT32_C(1) << 0)
#define RCC_AHB2ENR_GPIOBEN   (UINT32_C(1) << 1)
#define RCC_AHB2ENR_GPIOCEN   (UINT32_C(1) << 2)
#define RCC_AHB2ENR_ADC12EN   (UINT32_C(1) << 13)
#define RCC_APB1ENR1_TIM2EN   (UINT32_C(1) << 0)
#define RCC_APB1ENR1_TIM4EN   (UINT32_C(1) << 2)
#define RCC_APB1ENR1_PWREN    (UINT32_C(1) << 28)
#define RCC_APB2ENR_TIM1EN    (UINT32_C(1) << 11)

/* ---- 9.4 GPIO ---- */
typedef struct stm32g4_gpio {
    stm32g4_reg_t MODER; /* two bits a pin: 1 output, 2 alternate, 3 analog */
    stm32g4_reg_t OTYPER;
    stm32g4_reg_t OSPEEDR; /* two bits a pin */
    stm32g4_reg_t PUPDR;   /* two bits a pin: 1 up, 2 down */
    stm32g4_reg_t IDR;
    stm32g4_reg_t ODR;
    stm32g4_reg_t BSRR;
    stm32g4_reg_t LCKR;
    stm32g4_reg_t AFR[2]; /* four bits a pin */
} stm32g4_gpio_t;

/* ---- 29.6 TIM1, and 30.5 TIM2 and TIM4 (whose registers are a subset at the same offsets) ---- */
typedef struct stm32g4_tim {
    stm32g4_reg_t CR1;    /* 0x00  29.6.1 */
    stm32g4_reg_t CR2;    /* 0x04  29.6.2 */
    stm32g4_reg_t SMCR;   /* 0x08  29.6.3 */
    stm32g4_reg_t DIER;   /* 0x0C  29.6.4 */
    stm32g4_reg_t SR;     /* 0x10  29.6.5 */
    stm32g4_reg_t EGR;    /* 0x14  29.6.6 */
    stm32g4_reg_t CCMR1;  /* 0x18  29.6.8 */
    stm32g4_reg_t CCMR2;  /* 0x1C  29.6.10 */
    stm32g4_reg_t CCER;   /* 0x20  29.6.11 */
    stm32g4_reg_t CNT;    /* 0x24  29.6.12 */
    stm32g4_reg_t PSC;    /* 0x28  29.6.13 */
    stm32g4_reg_t ARR;    /* 0x2C  29.6.14 */
    stm32g4_reg_t RCR;    /* 0x30  29.6.15 */
    stm32g4_reg_t CCR[4]; /* 0x34  29.6.16 to 29.6.19: channels 1 to 4 */
    stm32g4_reg_t BDTR;   /* 0x44  29.6.20 */
    stm32g4_reg_t CCR5;   /* 0x48  29.6.21 */
    stm32g4_reg_t CCR6;   /* 0x4C  29.6.22 */
    stm32g4_reg_t CCMR3;  /* 0x50  29.6.23 */
    stm32g4_reg_t gap_54[226];
    stm32g4_reg_t DCR;  /* 0x3DC 29.6.29 */
    stm32g4_reg_t DMAR; /* 0x3E0 29.6.30 */
} stm32g4_tim_t;
#define TIM_CR1_CEN            (UINT32_C(1) << 0)
#define TIM_CR1_URS            (UINT32_C(1) << 2)
#define TIM_CR1_DIR            (UINT32_C(1) << 4) /* read: counting down */
#define TIM_CR1_CMS_CENTRE_1   (UINT32_C(1) << 5)
#define TIM_CR1_ARPE           (UINT32_C(1) << 7)
#define TIM_CR2_MMS_OC4        (UINT32_C(7) << 4)   /* TRGO: OC4REF */
#define TIM_CR2_MMS2_OC4       (UINT32_C(7) << 20)  /* TRGO2: OC4REF */
#define TIM_CR2_MMS2_OC4_OC6   (UINT32_C(13) << 20) /* TRGO2: OC4REF rising or OC6REF falling */
#define TIM_SMCR_ENCODER_X4    UINT32_C(3)
#define TIM_DIER_UDE           (UINT32_C(1) << 8) /* a DMA request at the update event */
#define TIM_SR_BIF             (UINT32_C(1) << 7)
#define TIM_EGR_UG             (UINT32_C(1) << 0)
#define TIM_CCMR_PWM_2_LOW     (UINT32_C(7) << 4) /* odd channel of the pair */
#define TIM_CCMR_TOGGLE_LOW    (UINT32_C(3) << 4) /* the output changes where counter and compare value agree */
#define TIM_CCMR_INACTIVE_LOW  (UINT32_C(4) << 4) /* the output is low at once */
#define TIM_CCMR_PRELOAD_LOW   (UINT32_C(1) << 3)
#define TIM_CCMR_PWM_2_HIGH    (UINT32_C(7) << 12) /* even channel */
#define TIM_CCMR_TOGGLE_HIGH   (UINT32_C(3) << 12)
#define TIM_CCMR_INACTIVE_HIGH (UINT32_C(4) << 12)
#define TIM_CCMR_PRELOAD_HIGH  (UINT32_C(1) << 11)
#define TIM_CCMR1_INPUTS       (UINT32_C(1) << 0 | UINT32_C(1) << 8)  /* TI1 and TI2 */
#define TIM_CCMR1_FILTERS      (UINT32_C(3) << 4 | UINT32_C(3) << 12) /* eight samples alike */
#define TIM_CCMR1_CAPTURE_TRC  UINT32_C(3) /* channel 1 captures at the internal trigger */
#define TIM_CCER_CC1E          UINT32_C(1)
#define TIM_CCER_LEGS          UINT32_C(0x555) /* CC1E CC1NE CC2E CC2NE CC3E CC3NE */
#define TIM_BDTR_DTG_MASK      UINT32_C(0xFF)
#define TIM_BDTR_LOCK_1        (UINT32_C(1) << 8) /* dead time and break stay as they are until reset */
#define TIM_BDTR_OSSI          (UINT32_C(1) << 10)
#define TIM_BDTR_OSSR          (UINT32_C(1) << 11)
#define TIM_BDTR_BKE           (UINT32_C(1) << 12) /* break input on; BKP = 0: active low */
#define TIM_BDTR_MOE           (UINT32_C(1) << 15)

/* DCR: a burst of `length` writes to DMAR goes to as many registers, from the one with this number on (its offset over 4). */
#define TIM_DCR_BURST(first, length) (((uint32_t)(length)-1) << 8 | (uint32_t)(first))
#define TIM_ARR_NUMBER               (0x2C / 4)

/* ---- 12.6 DMA ---- */
typedef struct stm32g4_dma {
    stm32g4_reg_t ISR;    /* 0x00 */
    stm32g4_reg_t IFCR;   /* 0x04 */
    stm32g4_reg_t CCR1;   /* 0x08: channel 1 */
    stm32g4_reg_t CNDTR1; /* 0x0C */
    stm32g4_reg_t CPAR1;  /* 0x10 */
    stm32g4_reg_t CMAR1;  /* 0x14 */
} stm32g4_dma_t;
#define DMA_CCR_EN            (UINT32_C(1) << 0)
#define DMA_CCR_TO_PERIPHERAL (UINT32_C(1) << 4)
#define DMA_CCR_CIRC          (UINT32_C(1) << 5)
#define DMA_CCR_MINC          (UINT32_C(1) << 7)
#define DMA_CCR_PSIZE_32      (UINT32_C(2) << 8)
#define DMA_CCR_MSIZE_16      (UINT32_C(1) << 10)
#define DMA_CCR_PL_VERY_HIGH  (UINT32_C(3) << 12)

/* ---- 13.6 DMAMUX: C0CR is DMA1's channel 1 ---- */
typedef struct stm32g4_dmamux {
    stm32g4_reg_t C0CR; /* 0x00 */
} stm32g4_dmamux_t;
#define DMAMUX_TIM1_UP UINT32_C(46)

/* ---- 21.7 ADC ---- */
typedef struct stm32g4_adc {
    stm32g4_reg_t ISR;        /* 0x00 */
    stm32g4_reg_t IER;        /* 0x04 */
    stm32g4_reg_t CR;         /* 0x08 */
    stm32g4_reg_t CFGR;       /* 0x0C */
    stm32g4_reg_t CFGR2;      /* 0x10 */
    stm32g4_reg_t SMPR1;      /* 0x14: channels 0 to 9, three bits each */
    stm32g4_reg_t SMPR2;      /* 0x18 */
    stm32g4_reg_t gap_1c[12]; /* 0x1C */
    stm32g4_reg_t JSQR;       /* 0x4C */
    stm32g4_reg_t gap_50[12]; /* 0x50 */
    stm32g4_reg_t JDR[4];     /* 0x80 */
} stm32g4_adc_t;
#define ADC_ISR_ADRDY         (UINT32_C(1) << 0)
#define ADC_ISR_JEOS          (UINT32_C(1) << 6)
#define ADC_IER_JEOSIE        (UINT32_C(1) << 6)
#define ADC_CR_ADEN           (UINT32_C(1) << 0)
#define ADC_CR_JADSTART       (UINT32_C(1) << 3)
#define ADC_CR_ADVREGEN       (UINT32_C(1) << 28)
#define ADC_CR_DEEPPWD        (UINT32_C(1) << 29)
#define ADC_CR_ADCAL          (UINT32_C(1) << 31)
#define ADC_CFGR_JQDIS        (UINT32_C(1) << 31)
#define ADC_SMPR_6_5(channel) (UINT32_C(1) << (3 * (channel))) /* 6.5 clocks */
#define ADC_JSQR_LENGTH(n)    ((uint32_t)(n)-1)
/* JEXTSEL: 21.4.19, external triggers of injected channels. */
#define ADC_JSQR_TIM1_TRGO2      (UINT32_C(8) << 2)
#define ADC_JSQR_RISING          (UINT32_C(1) << 7)
#define ADC_JSQR_FIRST(channel)  ((uint32_t)(channel) << 9)
#define ADC_JSQR_SECOND(channel) ((uint32_t)(channel) << 15)

/* 21.8: the part common to ADC1 and ADC2; 0x300 above ADC1. */
typedef struct stm32g4_adc_common {
    stm32g4_reg_t CSR;
    stm32g4_reg_t gap_04;
    stm32g4_reg_t CCR; /* 0x08 */
} stm32g4_adc_common_t;
#define ADC_CCR_CKMODE_HCLK_4 (UINT32_C(3) << 16)

/* ---- Armv7-M NVIC; 14.3 gives ADC1 and ADC2 interrupt 18 ---- */
typedef struct stm32g4_nvic {
    stm32g4_reg_t ISER[8];
} stm32g4_nvic_t;
#define STM32G4_ADC1_2_IRQ 18

/* Where they are (2.2.2); a test puts a bank of memory in their place. */
typedef struct stm32g4_chip {
    stm32g4_flash_t *flash;
    stm32g4_pwr_t *pwr;
    stm32g4_rcc_t *rcc;
    stm32g4_gpio_t *gpioa;
    stm32g4_gpio_t *gpiob;
    stm32g4_gpio_t *gpioc;
    stm32g4_tim_t *tim1; /* carrier */
    stm32g4_tim_t *tim2; /* free-running clock, 32 bits */
    stm32g4_tim_t *tim4; /* encoder */
    stm32g4_adc_t *adc1;
    stm32g4_adc_t *adc2;
    stm32g4_adc_common_t *adc12;
    stm32g4_nvic_t *nvic;
    stm32g4_dma_t *dma1; /* of edges (edges.h) */
    stm32g4_dmamux_t *dmamux;
} stm32g4_chip_t;

#define STM32G4_CLOCK_HZ 170000000

/* Every access goes through these two, so that a test can watch the order. */
#ifdef STM32G4_BUS_HEADER
#include STM32G4_BUS_HEADER
#else
static inline void stm32g4_write(stm32g4_reg_t *reg, uint32_t value)
{
    *reg = value;
}

static inline uint32_t stm32g4_read(stm32g4_reg_t *reg)
{
    return *reg;
}
#endif

#endif
