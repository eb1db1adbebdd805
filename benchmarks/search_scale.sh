#!/usr/bin/env bash
# Cost of every kind of search against the size of the map: one run of `recollect bench search` a
# size, then a table, a fit of cost = constant * frames^exponent, and a plot.
# Usage: benchmarks/search_scale.sh OUT LAP...    (from the repository's root, after make)
# OUT: folder for the JSON files, scale.csv, scale.txt (fits) and scale.svg. SIZES overrides sizes.
# Costs are in MB that one could have read from memory in the time, both measured in turns: a busy
# machine slows both. 100,000 key frames need 9 GB of memory and, while the map's file is opened, of
# TMPDIR.
set -euo pipefail
out=$1; shift
laps=(); for lap in "$@"; do laps+=(--lap "$lap"); done
sizes=${SIZES:-500 1000 2000 4415 10000 20000 50000 100000}
mkdir -p "$out"
kinds="exact exact_batch8 certified anytime restricted"
figure() { sed -n "s/^ *\"$2\": \([0-9.e-]*\),*$/\1/p" "$out/$1.json"; }
echo "frames $kinds open_ms" >"$out/scale.csv"
for frames in $sizes; do
  # Large maps take long, and their costs scatter less.
  checks=200 rounds=15
  if ((frames > 10000)); then checks=30 rounds=5; fi
  if [ ! -s "$out/$frames.json" ]; then
    build/recollect bench search "${laps[@]}" --frames "$frames" --checks $checks \
      --rounds $rounds --no-faiss --no-fatfast --no-plain --json "$out/$frames.json" \
      >"$out/$frames.txt"
  fi
  row=$frames
  for kind in $kinds; do
    row+=" $(awk -v t="$(figure "$frames" "${kind}_ms")" -v r="$(figure "$frames" read_ms)" \
      -v b="$(figure "$frames" bytes)" 'BEGIN { printf "%.3f", t / r * b / 1e6 }')"
  done
  echo "$row $(figure "$frames" open_ms)" >>"$out/scale.csv"
done
gnuplot <<PLOT
set terminal svg size 800,560 font 'sans,13' background '#ffffff'
set output '$out/scale.svg'
set logscale xy
set key left top
set grid
set xlabel 'key frames'
set ylabel 'cost of a query, in MB read in the same time'
set style data linespoints
plot for [i=2:6] '$out/scale.csv' using 1:i title columnheader(i) noenhanced lw 2
PLOT
gnuplot 2>"$out/scale.txt" <<FIT
set fit quiet logfile '/dev/null'
do for [i=2:6] {
  a = 1; b = -3
  f(x) = a * x + b
  fit f(x) '$out/scale.csv' using (log(\$1)):(log(column(i))) via a, b
  print sprintf("%-14s exponent %.2f, %.1f MB at 4415 key frames", word("$kinds", i - 1), a, exp(f(log(4415))))
}
FIT
cat "$out/scale.txt"
