# People who cross a street of 12 m: a stand-in for any simulator that writes what its trials came to. The numbers are those of
# Park and Miller (1988), so they are the same with every awk.
function draw(low, high) {
  state = (state * 16807) % 2147483647
  return low + (high - low) * state / 2147483647
}
BEGIN {
  state = 2026
  print "trial,query,value"
  for (trial = 0; trial < trials; trial++) {
    time = draw(0, 3) + 12 / draw(0.8, 1.6)
    printf "%d,safe,%s\n%d,time,%.3f s\n", trial, time <= 14 ? "true" : "false", trial, time
  }
}
