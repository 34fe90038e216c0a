# The share of the official return that is left from perturbed starts: a line per record.
# Wants: table (of `starts`), picture.

rows_of(record) = sprintf("< awk -F'\\t' -v OFS='\\t' '$1 == \"%s\" { if ($3 == 0) best = $4; else print $3, $4 / best, $5 / best }' '%s'", record, table)
records = system(sprintf("awk -F'\\t' 'NR > 1 && !seen[$1]++ { print $1 }' '%s'", table))
kind(record) = system(sprintf("awk -F'\\t' '$1 == \"%s\" { print $2; exit }' '%s'", record, table))
# Where a line ends, from the top, not nearer to the one above than a label is high.
labels = system(sprintf("awk -F'\t' 'NR > 1 { if ($3 == 0) best = $4; end[$1] = $4 / best } END { for (r in end) print end[r], r }' '%s' | sort -gr | awk '{ y = NR > 1 && $1 > y - 0.06 ? y - 0.06 : $1; print $2, y }'", table))
name(record) = system(sprintf("echo '%s' | sed 's/-v[0-9]*//; s/-sequence//'", record))

set terminal svg size 820,460 font 'DejaVu Sans,12' background rgb 'white'
set output picture
set datafile separator tab
set border 3 lc rgb '#555555'
set tics nomirror out textcolor rgb '#333333'
set grid y lc rgb '#dddddd' lw 1 lt 1
set logscale x
set xrange [6e-15:1.5e-2]
set xtics ('10^{-14}' 1e-14, '10^{-12}' 1e-12, '10^{-10}' 1e-10, '10^{-8}' 1e-8, '10^{-6}' 1e-6, '10^{-4}' 1e-4, '10^{-2}' 1e-2)
set yrange [-0.7:1.1]
set xlabel 'every coordinate of the start moved by up to so many voxels'
set ylabel 'mean return, as a share of the official one'
set rmargin 22
unset key
color(record) = kind(record) eq 'network' ? 0x0072B2 : 0xD55E00
do for [i = 1:words(labels):2] {
  r = word(labels, i)
  set label i sprintf('%s, %s', name(r), kind(r)) at graph 1.015, first real(word(labels, i + 1)) left textcolor rgb color(r) font ',10'
}
plot for [r in records] rows_of(r) using 1:2:3 with yerrorlines lw 2 pt 7 ps 0.4 lc rgb color(r)
