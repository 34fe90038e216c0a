# Control steps per second against the size of the body, as the benchmark's paper
# shows it: ours from a machine's file, the reference's dashed.
#
#   cd benchmarks && gnuplot -e "file='amd-epyc-zen3-avx2.csv'" speed.gnuplot > speed.svg && ../scripts/dark-aware speed.svg
if (!exists("file")) file = 'amd-epyc-zen3-avx2.csv'

set terminal svg size 760,500 font 'DejaVu Sans,12' background rgb 'white'
set datafile separator ','
set logscale xy
set xlabel "side of the body, voxels"
set ylabel "control steps per second, one core"
set xrange [4.5:39]
set yrange [20:80000]
set xtics (5, 10, 15, 20, 25, 30, 35)
set ytics add ("100" 100, "1 000" 1000, "10 000" 10000)
set mytics 10
set grid xtics ytics lc rgb '#dddddd' lw 1 lt 1
set border 3 lc rgb '#555555'
set tics nomirror out textcolor rgb '#333333'
set key bottom left reverse Left samplen 2.5 spacing 1.25

# The random bodies of one profile and number of environments, by size. (`seen`
# leaves out the line that --tasks has for the same task.)
rows(profile, width) = sprintf("< awk -F, '$1 == \"Walker-v0\" && $6 == %d && $8 == \"%s\" && !seen[$2 $5]++' %s", \
                               width, profile, file)

# A dot a body, a line through their means.
plot rows("fast", 8)   using 2:10 smooth unique with lines lw 2 lc "#D55E00" title "fast, 8 together", \
     rows("fast", 8)   using 2:10 with points pt 7 ps 0.4 lc "#D55E00" notitle, \
     rows("evogym", 8) using 2:10 smooth unique with lines lw 2 lc "#0072B2" title "exact, 8 together", \
     rows("evogym", 8) using 2:10 with points pt 7 ps 0.4 lc "#0072B2" notitle, \
     rows("evogym", 1) using 2:10 smooth unique with lines lw 2 lc "#56B4E9" title "exact, alone", \
     rows("evogym", 1) using 2:10 with points pt 7 ps 0.4 lc "#56B4E9" notitle, \
     'reference.csv' using 1:3 with lines dt (8, 6) lw 2 lc "#666666" title "reference simulator, 2.3 GHz server"
