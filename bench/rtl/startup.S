/* Start-up on a simulated RV32, which may have no machine mode: stack, zeroed data, main. All sections are loaded where they run. */
    .section .text.start, "ax"
    .globl start
start:
    .option push
    .option norelax
    la gp, __global_pointer$
    .option pop
    la sp, link_stack_top
    la t0, link_bss_start
    la t1, link_bss_end
1:  bgeu t0, t1, 2f
    sw zero, 0(t0)
    addi t0, t0, 4
    j 1b
2:  call main
    call console_exit
