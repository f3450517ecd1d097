; Start from flash: the boot ROM branches to the first two words of flash. The watchdog is off before the
; run-time library's start routine copies the functions that run from RAM (link_*.cmd) and initialises
; variables; c2000_clock_start leaves it off.

        .ref    _c_int00
        .sect   "codestart"
        .retain
        .global code_start
code_start:
        LB      watchdog_off

        .text
watchdog_off:
        SETC    OBJMODE
        EALLOW
        MOVZ    DP, #7029h >> 6
        MOV     @7029h, #0068h          ; WDCR: WDDIS, WDCHK = 101
        EDIS
        LB      _c_int00

        .end
