/*
 * Registers of the STM32F405 that this port uses: RM0090 revision 11; comments give its sections. Pins: data
 * sheet DS8626, table "Alternate function mapping"; check them against your package.
 */
#ifndef STM32F405_H
#define STM32F405_H

#include <stdint.h>

typedef volatile uint32_t reg_t;

/* On the chip a register is memory. The checks on the host name a header with functions instead. */
#ifdef STM32F405_BUS_HEADER
#include STM32F405_BUS_HEADER
#else
static inline void reg_write(reg_t *reg, uint32_t value)
{
    *reg = value;
}

static inline uint32_t reg_read(reg_t *reg)
{
    return *reg;
}
#endif

#define BIT(n) (UINT32_C(1) << (n))

typedef struct stm32f405_flash { /* 3.9 */
    reg_t ACR;
} stm32f405_flash_t;
#define FLASH_ACR_5_WAITS (UINT32_C(5) | BIT(8) | BIT(9) | BIT(10)) /* prefetch, both caches */

typedef struct stm32f405_rcc { /* 7.3 */
    reg_t CR, PLLCFGR, CFGR, CIR;
    reg_t gap_10[8];
    reg_t AHB1ENR; /* 0x30 */
    reg_t gap_34[3];
    reg_t APB1ENR, APB2ENR; /* 0x40 */
} stm32f405_rcc_t;
#define RCC_CR_HSION  BIT(0)
#define RCC_CR_HSIRDY BIT(1)
#define RCC_CR_PLLON  BIT(24)
#define RCC_CR_PLLRDY BIT(25)
/* 16 MHz / 8 * 168 / 2 = 168 MHz; Q = 7. Source: HSI. */
#define RCC_PLLCFGR_168_MHZ   (UINT32_C(8) | UINT32_C(168) << 6 | UINT32_C(0) << 16 | UINT32_C(7) << 24)
#define RCC_CFGR_PRESCALERS   (UINT32_C(5) << 10 | UINT32_C(4) << 13) /* APB1 42 MHz, APB2 84 MHz */
#define RCC_CFGR_SW_PLL       UINT32_C(2)
#define RCC_CFGR_SWS_MASK     UINT32_C(0xC)
#define RCC_CFGR_SWS_PLL      UINT32_C(0x8)
#define RCC_AHB1ENR_GPIO_ABC  (BIT(0) | BIT(1) | BIT(2))
#define RCC_APB1ENR_TIM2_TIM4 (BIT(0) | BIT(2))
#define RCC_APB2ENR_TIM1_ADCS (BIT(0) | BIT(8) | BIT(9) | BIT(10))

typedef struct stm32f405_gpio { /* 8.4 */
    reg_t MODER, OTYPER, OSPEEDR, PUPDR, IDR, ODR, BSRR, LCKR;
    reg_t AFR[2];
} stm32f405_gpio_t;

typedef struct stm32f405_tim { /* 17.4 (TIM1), 18.4 (TIM2, TIM4) */
    reg_t CR1, CR2, SMCR, DIER, SR, EGR;
    reg_t CCMR1, CCMR2, CCER;
    reg_t CNT, PSC, ARR, RCR;
    reg_t CCR[4];
    reg_t BDTR;
} stm32f405_tim_t;
#define TIM_CR1_CEN       BIT(0)
#define TIM_CR1_URS       BIT(2)
#define TIM_CR1_DIR       BIT(4)
#define TIM_CR1_CENTRE_1  BIT(5)
#define TIM_CR1_ARPE      BIT(7)
#define TIM_CR2_MMS_UP    (UINT32_C(2) << 4)          /* the update event is TRGO */
#define TIM_CCMR_PWM_1    (UINT32_C(6) << 4 | BIT(3)) /* 17.4.7: active below CCR; preload */
#define TIM_CCMR_BOTH     (TIM_CCMR_PWM_1 | TIM_CCMR_PWM_1 << 8)
#define TIM_CCER_LEGS     UINT32_C(0x555) /* three channels and complements */
#define TIM_BDTR_LOCK_1   BIT(8)
#define TIM_BDTR_OFF_LOW  (BIT(10) | BIT(11)) /* OSSI, OSSR: off is driven low */
#define TIM_BDTR_BKE      BIT(12)             /* break input, active low */
#define TIM_BDTR_MOE      BIT(15)
#define TIM_SR_UIF        BIT(0)
#define TIM_SR_CC3IF      BIT(3)
#define TIM_SR_BIF        BIT(7)
#define TIM_EGR_UG        BIT(0)
#define TIM_SMCR_ENCODER  UINT32_C(3) /* both edges of both inputs */
#define TIM_CCMR1_INPUTS  (BIT(0) | BIT(8) | UINT32_C(3) << 4 | UINT32_C(3) << 12) /* filtered */
#define TIM_CCMR2_CAPTURE (BIT(0) | UINT32_C(3) << 4) /* CC3 from TI3: the index */
#define TIM_CCER_CC3E     BIT(8)

typedef struct stm32f405_adc { /* 13.13 */
    reg_t SR, CR1, CR2;
    reg_t SMPR1, SMPR2;
    reg_t JOFR[4];
    reg_t HTR, LTR;
    reg_t SQR[3];
    reg_t JSQR; /* 0x38 */
    reg_t JDR[4];
    reg_t DR;
} stm32f405_adc_t;
typedef struct stm32f405_adc_common {
    reg_t CSR, CCR, CDR;
} stm32f405_adc_common_t;
#define ADC_SR_JEOC            BIT(2)
#define ADC_CR1_JEOCIE         BIT(7)
#define ADC_CR1_SCAN           BIT(8)
#define ADC_CR2_ADON           BIT(0)
#define ADC_CR2_JEXT_TIM1_TRGO (UINT32_C(1) << 16 | BIT(20)) /* rising edge */
#define ADC_CCR_PCLK2_4        (UINT32_C(1) << 16)           /* 21 MHz; at most 36 */
#define ADC_SMPR1_10_13        UINT32_C(0x249)               /* channels 10 to 13: 15 clocks, 0.7 us */
#define ADC_JSQR_ONE(x)        ((uint32_t)(x) << 15)         /* a sequence of one sits in JSQ4 */
#define ADC_JSQR_TWO(x, y)     (BIT(20) | (uint32_t)(x) << 10 | (uint32_t)(y) << 15)

typedef struct stm32f405_nvic {
    reg_t ISER[8];
} stm32f405_nvic_t;
#define ADC_IRQ 18

/* Where they are: memory on the host, 2.3 on the chip. */
typedef struct stm32f405_chip {
    stm32f405_flash_t *flash;
    stm32f405_rcc_t *rcc;
    stm32f405_gpio_t *gpioa, *gpiob, *gpioc;
    stm32f405_tim_t *tim1, *tim2, *tim4;
    stm32f405_adc_t *adc[3];
    stm32f405_adc_common_t *adc_common;
    stm32f405_nvic_t *nvic;
} stm32f405_chip_t;

#endif
