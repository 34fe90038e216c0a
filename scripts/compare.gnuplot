# Best-so-far against evaluations, mean and range over runs; one panel per task.
# Wants: table (compare.tsv), picture (file), format (svg, png, pdf).

values(field) = system(sprintf("awk -F'\\t' 'NR > 1 && !seen[$%d]++ { print $%d }' '%s'", field, field, table))
tasks = values(1)
methods = values(2)
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
set key bottom right samplen 2 spacing 1.2 textcolor rgb '#333333'
set style fill transparent solid 0.18 noborder
set xlabel 'robots evaluated'
set ylabel 'best fitness so far'
set autoscale xfixmax
set offsets graph 0, 0.02, 0.03, 0
set multiplot layout rows, columns margins char 9, char 3, char 4, char 3 spacing char 10, char 6
do for [task in tasks] {
  set title task font ',16'
  of(method, value) = stringcolumn(1) eq task && stringcolumn(2) eq method ? value : NaN
  plot for [m in methods] table using (of(m, $3)):7:8 with filledcurves lc rgb color(m) notitle, \
       for [m in methods] table using (of(m, $3)):5 with lines lw 2.5 lc rgb color(m) title label(m)
}
unset multiplot
