# Best so far against environment steps: runs of the suite beside the benchmark paper's
# GA, one panel per task. Wants: table (of `progress`), paper (paper-curves.tsv), picture.

rows_of(run) = sprintf("< awk -F'\\t' -v OFS='\\t' '$3 == \"%s\" { if (n++) print $4, best; print $4, best = $5 }' '%s'", run, table)
paper_of(task) = sprintf("< awk -F'\\t' -v OFS='\\t' '$1 == \"%s\" { if (n++) print $2 * 512000, best; print $2 * 512000, best = $3 }' '%s'", task, paper)
tasks = system(sprintf("awk -F'\\t' 'NR > 1 && !seen[$1]++ { print $1 }' '%s'", table))
runs(task, series) = system(sprintf("awk -F'\\t' '$1 == \"%s\" && $2 == \"%s\" && !seen[$3]++ { print $3 }' '%s'", task, series, table))
all_series = system(sprintf("awk -F'\\t' 'NR > 1 && !seen[$2]++ { print $2 }' '%s'", table))
panels = words(tasks)
columns = 4
rows = (panels + columns - 1) / columns

set terminal svg size 60 + 330 * columns, 60 + 270 * rows font 'DejaVu Sans,12' background rgb 'white'
set output picture

# Okabe and Ito's colours, told apart by everyone.
color(series) = series eq 'sequence' ? 0xD55E00 : series eq 'network' ? 0x0072B2 : 0x009E73

set datafile separator tab
set border 3 lc rgb '#555555'
set tics nomirror out textcolor rgb '#333333'
set grid y lc rgb '#dddddd' lw 1 lt 1
set logscale x
set xrange [1e5:5e8]
set xtics ('10^5' 1e5, '10^6' 1e6, '10^7' 1e7, '10^8' 1e8)
unset key
set offsets 0, 0, graph 0.05, graph 0.05
set multiplot layout rows, columns margins char 11, char 2, char 3.5, char 4.5 spacing char 7, char 5
# The legend, above all panels.
set label 1 "the paper's GA" at screen 0.98, screen 1 offset char 0, char -1.2 right textcolor rgb '#666666'
do for [i = 1:words(all_series)] {
  set label i + 1 word(all_series, i) at screen 0.98, screen 1 offset char -16 * i, char -1.2 right textcolor rgb color(word(all_series, i))
}
panel = 0
do for [task in tasks] {
  panel = panel + 1
  set title task font ',14'
  set xlabel (panel > panels - columns ? 'environment steps' : '')
  set ylabel (panel % columns == 1 ? 'best so far' : '')
  plot paper_of(task) using 1:2 with lines lw 2 dt 2 lc rgb '#666666', \
       for [s in all_series] for [r in runs(task, s)] rows_of(r) using 1:2 with lines lw 2.2 \
         lc rgb color(s)
  unset label
}
unset multiplot
