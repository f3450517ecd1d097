/* Start-up of the emulated RV32: stack, traps, zeroed data, main. All sections are loaded where they run. A core without machine mode is
 * built with WITHOUT_TRAPS (bench/rtl.py). */
    .section .text.start, "ax"
    .globl start
start:
    .option push
    .option norelax
    la gp, __global_pointer$
    .option pop
    la sp, link_stack_top
#ifndef WITHOUT_TRAPS
    la t0, trap_handler
    csrw mtvec, t0
#endif
    la t0, link_bss_start
    la t1, link_bss_end
1:  bgeu t0, t1, 2f
    sw zero, 0(t0)
    addi t0, t0, 4
    j 1b
2:  call main
    call console_exit
