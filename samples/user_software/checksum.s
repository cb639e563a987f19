| Sum of the bytes of a stretch of memory.
| In:  D0 = address of two longs: first address, number of bytes.   Out: D0 = sum, 32 bits.
        .text
        .globl  _start
_start: movea.l %d0,%a0
        movea.l (%a0),%a1
        move.l  4(%a0),%d2
        moveq   #0,%d0
        moveq   #0,%d1
        bra.s   test
next:   move.b  (%a1)+,%d1
        add.l   %d1,%d0
        subq.l  #1,%d2
test:   tst.l   %d2
        bne.s   next
        rts
