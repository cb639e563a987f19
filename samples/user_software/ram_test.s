| Tests 4,096 bytes with two patterns and leaves what was there.
| In:  D0 = first address.   Out: D0 = 0, or the first byte that does not hold what is written.
        .text
        .globl  _start
_start: movea.l %d0,%a0
        move.w  #4095,%d3
next:   move.b  (%a0),%d1               | keep
        move.b  #0x55,(%a0)
        cmpi.b  #0x55,(%a0)
        bne.s   bad
        move.b  #0xAA,(%a0)
        cmpi.b  #0xAA,(%a0)
        bne.s   bad
        move.b  %d1,(%a0)+
        dbf     %d3,next
        moveq   #0,%d0
        rts
bad:    move.b  %d1,(%a0)
        move.l  %a0,%d0
        rts
