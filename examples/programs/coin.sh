# Tosses a coin ten times and writes how often heads came up: `sh coin.sh SEED P`. The numbers are those of Park and Miller (1988),
# so they are the same with every awk.
awk -v seed="$1" -v p="$2" 'BEGIN {
  state = seed % 2147483646 + 1
  print "t,heads"
  for (toss = 0; toss <= 10; toss++) {
    print toss "," heads + 0
    state = (state * 16807) % 2147483647
    heads += state < p * 2147483647
  }
}'
