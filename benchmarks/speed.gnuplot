# Control steps a second against the size of the body, as the benchmark's paper
# shows it: ours from a machine's file, the reference's dashed.
#
#   cd benchmarks && gnuplot -e "file='amd-epyc-zen3-avx2.csv'" speed.gnuplot > speed.svg
if (!exists("file")) file = 'amd-epyc-zen3-avx2.csv'

set terminal svg size 760,500 font "Helvetica,14" background "#ffffff"
set datafile separator ','
set logscale xy
set xlabel "side of the body, voxels" textcolor "#333333"
set ylabel "control steps a second, one core" textcolor "#333333"
set xrange [4.5:39]
set yrange [20:80000]
set xtics (5, 10, 15, 20, 25, 30, 35)
set ytics add ("100" 100, "1 000" 1000, "10 000" 10000)
set mytics 10
set grid xtics ytics linecolor "#e4e4e4" linetype 1 linewidth 1
set border 3 linecolor "#888888"
set tics nomirror textcolor "#333333"
set key bottom left reverse Left samplen 2.5 spacing 1.25 textcolor "#333333"

# The lines of one profile and number of environments, of sizes (task Walker-v0).
rows(profile, width) = sprintf("< awk -F, '$1 == \"Walker-v0\" && $2 == $3 && $5 == %d && $7 == \"%s\" && !seen[$2]++' %s", \
                               width, profile, file)

plot rows("fast", 8)   using 2:9 with linespoints pt 7 ps 0.7 lw 2 lc "#d1495b" title "fast, 8 together", \
     rows("evogym", 8) using 2:9 with linespoints pt 7 ps 0.7 lw 2 lc "#00798c" title "exact, 8 together", \
     rows("evogym", 1) using 2:9 with linespoints pt 7 ps 0.7 lw 2 lc "#8fb8c4" title "exact, alone", \
     'reference.csv' using 1:3 with lines dt (8, 6) lw 2 lc "#666666" title "reference simulator, 2.3 GHz server"
