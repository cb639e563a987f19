| Writes the position of X, Y and Z [um] once a period into a table.
| In:  D0 = number of samples, at most 1,000.   Out: D0 = samples written.
| The table begins at 0x042000: period, X, Y, Z, a long each.
        .text
        .globl  _start
        .equ    inputs, 0x0E0000        | period, X, Y, Z [um], axes present
        .equ    table,  0x042000
_start: move.l  %d0,%d2
        cmpi.l  #1000,%d2
        bls.s   begin
        move.l  #1000,%d2
begin:  moveq   #0,%d0
        lea     inputs,%a0
        lea     table,%a1
        move.l  (%a0),%d3               | this period
sample: cmp.l   %d0,%d2
        beq.s   done
        move.l  %d3,(%a1)+
        move.l  4(%a0),(%a1)+
        move.l  8(%a0),(%a1)+
        move.l  12(%a0),(%a1)+
        addq.l  #1,%d0
wait:   move.l  (%a0),%d4
        cmp.l   %d3,%d4
        beq.s   wait
        move.l  %d4,%d3
        bra.s   sample
done:   rts
