; The flat of thesis 7.3: 1800 by 800 mm in the XZ plane, once over with a face cutter. Its place on the bed and the distance
; of the passes are ours; the thesis prints neither.
; ecs-emulator run --machine machine.toml flat_xz.nc --trace flat.csv
> G90G00X-1100.0Z-50.0   ;EVERY PASS COMES TO ITS START THE SAME WAY
> X-1150.0Z-100.0
> G00Y-1200.0
> G04H1
$REP 4
> G91G01X-1800.0F3000
> Z-100.0
> X1800.0
> Z-100.0
$END
> X-1800.0        ;NINTH PASS
> M30
