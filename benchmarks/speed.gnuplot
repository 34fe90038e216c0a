# The figure of README.md, from speed.csv (see `speed`); run from the root of the repository.
set terminal svg size 760,500 font 'DejaVu Sans,12' background rgb 'white'
set datafile separator ','
set logscale xy
set xlabel "side of the body, voxels"
set ylabel "control steps per second, one core"
set xrange [4.5:39]
set yrange [20:110000]
set xtics (5, 10, 15, 20, 25, 30, 35)
set ytics add ("100" 100, "1 000" 1000, "10 000" 10000, "100 000" 100000)
set mytics 10
set grid xtics ytics lc rgb '#dddddd' lw 1 lt 1
set border 3 lc rgb '#555555'
set tics nomirror out textcolor rgb '#333333'
set key bottom left reverse Left samplen 2.5 spacing 1.25

rows(machine, envs) = sprintf("< awk -F, '$1 ~ /%s/ && $3 == %d' benchmarks/speed.csv", machine, envs)

plot rows("Zen 5", 8) using 2:4 with linespoints pt 7 ps 0.4 lw 2 lc "#D55E00" title "AMD Zen 5, 8 together", \
     rows("Zen 4", 8) using 2:4 with linespoints pt 7 ps 0.4 lw 2 lc "#E69F00" title "AMD Zen 4, 8 together", \
     rows("Zen 3", 8) using 2:4 with linespoints pt 7 ps 0.4 lw 2 lc "#0072B2" title "AMD Zen 3, 8 together", \
     rows("Zen 3", 1) using 2:4 with linespoints pt 7 ps 0.4 lw 2 lc "#56B4E9" title "AMD Zen 3, alone", \
     rows("Evolution Gym", 1) using 2:4 with linespoints pt 7 ps 0.4 dt (8, 6) lw 2 lc "#666666" title "Evolution Gym's simulator, 2.3 GHz server"
