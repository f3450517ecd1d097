/* The STM32G474's bus as the proof has it: a read gives anything that the register can hold. */
#ifndef TESTS_PROVE_BUS_H
#define TESTS_PROVE_BUS_H

uint32_t stm32g4_read(stm32g4_reg_t *reg);
void stm32g4_write(stm32g4_reg_t *reg, uint32_t value);

#endif
