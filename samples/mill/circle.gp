# Figure 7.22 of the thesis: the circle of circle_xz.nc before and after compensation, deviations from the least-squares
# circle as a polar plot. From the folder with the two traces:
#   gnuplot -e "before='circle_before.csv'; after='circle_after.csv'" circle.gp      writes circle.svg
set datafile separator ','
set terminal svg size 1000,560 enhanced font 'sans,13' background rgb 'white'
set output 'circle.svg'
division = 10.0              # um
inner = 40.0                 # um on paper from the centre to the mean circle
centre_x = -2000.0
centre_z = -500.0
radius = 125.0
# columns: 2 line, 3 and 9 command X and Z, 12 and 14 error X and Z of the tool
turn(line) = line == 8 ? 1 : 2
angle(x, z) = atan2(z - centre_z, x - centre_x)
on(x, z) = abs(sqrt((x - centre_x)**2 + (z - centre_z)**2) - radius) < 1e-6
out(x, z, ex, ez) = on(x, z) ? ex * cos(angle(x, z)) + ez * sin(angle(x, z)) : NaN
set macros
row = "column(3), column(9), column(12), column(14)"
array mean_[2]; array ecc_x[2]; array ecc_z[2]; array round_[2]
files = before . ' ' . after
do for [i = 1:2] {
  file = word(files, i)
  stats file using (out(@row)) every ::1 nooutput
  mean_[i] = STATS_mean
  stats file using (2 * out(@row) * cos(angle(column(3), column(9)))) every ::1 nooutput
  ecc_x[i] = STATS_mean
  stats file using (2 * out(@row) * sin(angle(column(3), column(9)))) every ::1 nooutput
  ecc_z[i] = STATS_mean
  off(x, z, ex, ez) = out(x, z, ex, ez) - mean_[i] - ecc_x[i] * cos(angle(x, z)) - ecc_z[i] * sin(angle(x, z))
  stats file using (off(@row)) every ::1 nooutput
  round_[i] = STATS_max - STATS_min
}
set multiplot layout 1,2
set size ratio -1
set xrange [-90:90]
set yrange [-90:90]
unset border
unset tics
set key bottom center horizontal
do for [i = 1:2] {
  file = word(files, i)
  set title sprintf("%s: out of round %.0f um\n1 division = %.0f um", i == 1 ? "not compensated" : "compensated", round_[i], division)
  off(x, z, ex, ez) = out(x, z, ex, ez) - mean_[i] - ecc_x[i] * cos(angle(x, z)) - ecc_z[i] * sin(angle(x, z))
  px(x, z, ex, ez) = (inner + off(x, z, ex, ez)) * cos(angle(x, z))
  pz(x, z, ex, ez) = (inner + off(x, z, ex, ez)) * sin(angle(x, z))
  set parametric
  set trange [0:2 * pi]
  plot for [k = -3:4] (inner + k * division) * cos(t), (inner + k * division) * sin(t) with lines lw (k == 0 ? 1.2 : 0.5) lc rgb '#b0b0b0' notitle, \
       for [k = 0:1] 80 * (2 * t / (2 * pi) - 1) * (k == 0), 80 * (2 * t / (2 * pi) - 1) * (k == 1) with lines lw 0.5 lc rgb '#b0b0b0' notitle, \
       file using (turn(column(2)) == 1 ? px(@row) : NaN):(pz(@row)) every ::1 with lines lw 1.5 lc rgb '#0050a0' title 'Z towards X', \
       file using (turn(column(2)) == 2 ? px(@row) : NaN):(pz(@row)) every ::1 with lines lw 1.5 dt (8,4) lc rgb '#c04000' title 'X towards Z'
  unset parametric
}
unset multiplot
