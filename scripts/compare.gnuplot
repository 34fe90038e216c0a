# Best-so-far against evaluations, median and range over seeds; one panel per task. The
# best changes when a robot is evaluated, and not between: steps, no slopes.
# Wants: table (compare.tsv), picture (file), format (svg, png, pdf).

values(field) = system(sprintf("awk -F'\\t' 'NR > 1 && !seen[$%d]++ { print $%d }' '%s'", field, field, table))
tasks = values(1)
rows_of(task, method) = sprintf("awk -F'\\t' -v OFS='\\t' '$1 == \"%s\" && $2 == \"%s\"' '%s'", task, method, table)
methods(task) = system(sprintf("awk -F'\\t' '$1 == \"%s\" && !seen[$2]++ { print $2 }' '%s'", task, table))
seeds(task, method) = system(rows_of(task, method) . " | tail -n 1 | cut -f 4")
# evaluations, median, least, most; twice where a step is
steps(task, method) = '< ' . rows_of(task, method) . " | awk -F'\\t' -v OFS='\\t' 'NR > 1 { print $3, middle, low, high } { print $3, middle = $9, low = $7, high = $8 }'"
panels = words(tasks)
columns = panels < 3 ? panels : 3
rows = (panels + columns - 1) / columns

width = 120 + 520 * columns
height = 60 + 400 * rows
if (format eq 'svg') set terminal svg size width, height font 'DejaVu Sans,14' background rgb 'white'
if (format eq 'png') set terminal pngcairo size width, height font 'DejaVu Sans,11'
if (format eq 'pdf') set terminal pdfcairo size width / 100.0, height / 100.0 font 'DejaVu Sans,11'
set output picture

# The colours of the report (render/report/charts.js); a method without generations is dashed.
end(method) = strlen(method) - 7  # where -window begins
bare(method) = end(method) > 0 && method[end(method) + 1:] eq '-window' ? method[1:end(method)] : method
color(method) = bare(method) eq 'ga' ? 0xD9730D : bare(method) eq 'bo' ? 0x2F86C9 : bare(method) eq 'neat' ? 0x2B9A66 : \
  bare(method) eq 'map' ? 0x9A63C9 : bare(method) eq 'race' ? 0xD0456B : 0x7F8894
dash(method) = method eq bare(method) ? 1 : 2
name(method) = method eq 'ga' ? 'GA' : method eq 'neat' ? 'CPPN-NEAT' : method eq 'bo' ? 'Bayesian optimisation' : \
  method eq 'map' ? 'MAP-Elites' : method
label(method) = method eq bare(method) ? name(method) : name(bare(method)) . ' without generations'

set datafile separator tab
set border 3 lc rgb '#555555'
set tics nomirror out textcolor rgb '#333333'
set grid y lc rgb '#dddddd' lw 1 lt 1
set key below samplen 2 spacing 1.2 textcolor rgb '#333333'  # beside the curves, not on them
set style fill transparent solid 0.18 noborder
set xlabel 'robots evaluated (median and range of the seeds)'
set ylabel 'best fitness so far'
set autoscale xfixmax
set offsets graph 0, 0.02, 0.03, 0
set multiplot layout rows, columns margins char 9, char 3, char 7, char 3 spacing char 10, char 8
do for [task in tasks] {
  set title task font ',16'
  run = methods(task)
  plot for [m in run] steps(task, m) using 1:3:4 with filledcurves lc rgb color(m) notitle, \
       for [m in run] steps(task, m) using 1:2 with lines lw 2.5 dt dash(m) lc rgb color(m) \
         title sprintf('%s, %s seed%s', label(m), seeds(task, m), seeds(task, m) eq '1' ? '' : 's')
}
unset multiplot
