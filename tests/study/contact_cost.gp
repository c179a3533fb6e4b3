# Six of the scenes of contact_cost.c in one diagram: gnuplot -e "out = 'FILE.png'" contact_cost.gp, in the folder that has
# their out/bench/SCENE/bench.csv. Settings whose run is not ok are left out; errors that the reference cannot tell are drawn
# at what it can.
scenes = "cloth_on_sphere rotating_sphere stack soft_cube net hair_on_shoulder"
titles = "'9 x 9 particles land on a ball' '9 x 9 on a turning ball' 'two sheets of 4 x 4 on a floor' \
'a soft cube, one body' 'a ball in a net' 'hair on a shoulder'"
ways = "impulses zones force barrier"
colours = "#000000 #CC79A7 #0072B2 #D55E00"
set terminal pngcairo size 1320,860 font 'Sans,11' background rgb 'white'
set output out
set datafile separator ','
set logscale xy
set format xy '10^{%L}'
set tics nomirror scale 0.6
set border 3
set grid lc rgb '#DDDDDD' lt 1 lw 0.5
set xrange [2e-8:3e-2]
set yrange [5e-4:5]
set xlabel 'RMS error of the positions, m' offset 0,0.4
set ylabel 'wall time of the run, s' offset 1,0
error(text) = real(text[1:1] eq '<' ? text[2:*] : text)
shown(k, way) = strcol(12) eq 'ok' && strcol(1) eq k.' contact='.way ? error(strcol(8)) : NaN
set multiplot layout 2,3 margins 0.06,0.985,0.16,0.95 spacing 0.07,0.12
do for [s = 1:6] {
  set title word(titles, s) offset 0,-0.6
  if (s == 5) { set key at screen 0.5,0.04 center vertical maxrows 2 Left reverse samplen 3 } else { unset key }
  file = 'out/bench/'.word(scenes, s).'/bench.csv'
  plot for [w = 1:4] file using (shown('leapfrog', word(ways, w))):7 with linespoints lw 1.8 pt 7 ps 0.9 \
         lc rgb word(colours, w) title 'leapfrog, '.word(ways, w), \
       for [w = 1:4] file using (shown('bdf2', word(ways, w))):7 with linespoints lw 1.8 pt 4 ps 1 dt 2 \
         lc rgb word(colours, w) title 'bdf2, '.word(ways, w)
}
unset multiplot
