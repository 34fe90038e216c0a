# Best-so-far against evaluations, mean and range over seeds; one panel per task. The
# best changes when a robot is evaluated, and not between: steps, no slopes.
# Wants: table (compare.tsv), picture (file), format (svg, png, pdf).

values(field) = system(sprintf("awk -F'\\t' 'NR > 1 && !seen[$%d]++ { print $%d }' '%s'", field, field, table))
tasks = values(1)
rows_of(task, method) = sprintf("awk -F'\\t' -v OFS='\\t' '$1 == \"%s\" && $2 == \"%s\"' '%s'", task, method, table)
methods(task) = system(sprintf("awk -F'\\t' '$1 == \"%s\" && !seen[$2]++ { print $2 }' '%s'", task, table))
seeds(task, method) = system(rows_of(task, method) . " | tail -n 1 | cut -f 4")
# evaluations, mean, least, most; twice where a step is
steps(task, method) = '< ' . rows_of(task, method) . " | awk -F'\\t' -v OFS='\\t' 'NR > 1 { print $3, mean, low, high } { print $3, mean = $5, low = $7, high = $8 }'"
panels = words(tasks)
columns = panels < 3 ? panels : 3
rows = (panels + columns - 1) / columns

width = 120 + 520 * columns
height = 60 + 400 * rows
if (format eq 'svg') set terminal svg size width, height font 'DejaVu Sans,14' background rgb 'white'
if (format eq 'png') set terminal pngcairo size width, height font 'DejaVu Sans,11'
if (format eq 'pdf') set terminal pdfcairo size width / 100.0, height / 100.0 font 'DejaVu Sans,11'
set output picture

# Okabe and Ito's colours, told apart by everyone.
color(method) = method eq 'ga' ? 0xD55E00 : method eq 'neat' ? 0x009E73 : method eq 'bo' ? 0x0072B2 : 0x666666
label(method) = method eq 'ga' ? 'GA' : method eq 'neat' ? 'CPPN-NEAT' : method eq 'bo' ? 'Bayesian optimisation' : method

set datafile separator tab
set border 3 lc rgb '#555555'
set tics nomirror out textcolor rgb '#333333'
set grid y lc rgb '#dddddd' lw 1 lt 1
set key bottom right samplen 2 spacing 1.2 textcolor rgb '#333333' title 'mean and range' left
set style fill transparent solid 0.18 noborder
set xlabel 'robots evaluated'
set ylabel 'best fitness so far'
set autoscale xfixmax
set offsets graph 0, 0.02, 0.03, 0
set multiplot layout rows, columns margins char 9, char 3, char 4, char 3 spacing char 10, char 6
do for [task in tasks] {
  set title task font ',16'
  run = methods(task)
  plot for [m in run] steps(task, m) using 1:3:4 with filledcurves lc rgb color(m) notitle, \
       for [m in run] steps(task, m) using 1:2 with lines lw 2.5 lc rgb color(m) \
         title sprintf('%s, %s seed%s', label(m), seeds(task, m), seeds(task, m) eq '1' ? '' : 's')
}
unset multiplot
