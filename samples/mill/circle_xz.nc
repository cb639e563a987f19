; The circle of thesis 7.3: diameter 250 mm in the XZ plane, centre X-2000 Z-500, once in each sense.
; Approach and exit are quarter circles of radius 25 mm that join the circle without a corner.
; ecs-emulator run --machine machine.toml circle_xz.nc --trace circle.csv
> G90G18
> G00X-1900.0Z-475.0
> G04H1
> G03X-1875.0Z-500.0K-25.0F500 ;APPROACH
> G03X-1875.0Z-500.0I-125.0    ;ONCE ROUND, FROM Z TOWARDS X
> G03X-1900.0Z-525.0I-25.0     ;EXIT
> G04H2
> G02X-1875.0Z-500.0K25.0      ;APPROACH FROM THE OTHER SIDE
> G02X-1875.0Z-500.0I-125.0    ;ONCE ROUND, THE OTHER WAY
> G02X-1900.0Z-475.0I-25.0     ;EXIT
> G04H2
> M30
