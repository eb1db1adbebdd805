#!/usr/bin/env bash
# Cost of every kind of search against the size of the map: one run of `recollect bench search` a
# size, then a table, a fit of cost = constant * frames^exponent, and a plot.
# Usage: benchmarks/search_scale.sh OUT LAP...    (from the repository's root, after make)
# OUT: folder for the JSON files, scale.csv, scale.txt (fits) and scale.svg. SIZES overrides sizes.
set -euo pipefail
out=$1; shift
laps=(); for lap in "$@"; do laps+=(--lap "$lap"); done
sizes=${SIZES:-500 1000 2000 4415 10000 30000 100000}
mkdir -p "$out"
kinds="read exact exact_batch8 certified anytime restricted open"
echo "frames ${kinds// / }" >"$out/scale.csv"
for frames in $sizes; do
  build/recollect bench search "${laps[@]}" --frames "$frames" --checks 200 --rounds 15 \
    --no-faiss --no-fatfast --json "$out/$frames.json" >"$out/$frames.txt"
  row=$frames
  for kind in $kinds; do
    row+=" $(sed -n "s/^ *\"${kind}_ms\": \([0-9.e-]*\),*$/\1/p" "$out/$frames.json")"
  done
  echo "$row" >>"$out/scale.csv"
done
gnuplot <<PLOT
set terminal svg size 800,560 font 'sans,13' background '#ffffff'
set output '$out/scale.svg'
set logscale xy
set key left top
set grid
set xlabel 'key frames'
set ylabel 'ms a query, two cores'
set style data linespoints
plot for [i=2:7] '$out/scale.csv' using 1:i title columnheader(i) noenhanced lw 2
PLOT
gnuplot 2>"$out/scale.txt" <<FIT
set fit quiet logfile '/dev/null'
do for [i=2:7] {
  a = 1; b = -3
  f(x) = a * x + b
  fit f(x) '$out/scale.csv' using (log(\$1)):(log(column(i))) via a, b
  print sprintf("%-14s exponent %.2f, %.4f ms a thousand key frames at 4415", word("$kinds", i - 1), a, exp(f(log(4415))) / 4.415)
}
FIT
cat "$out/scale.txt"
