# A simulation in the hands of its user: a mass on a spring under a push, by the classic method of Runge and Kutta. Reads rows
# of time and push, and writes the displacement to the file `out`. The stiffness is k.
BEGIN { FS = ","; m = 2; c = 12; print "x" > out }
FNR == 1 { next }
FNR > 2 {
  h = $1 - time; half = (push + $2) / 2
  d1 = v;               a1 = rate(x, v, push)
  d2 = v + h / 2 * a1;  a2 = rate(x + h / 2 * d1, d2, half)
  d3 = v + h / 2 * a2;  a3 = rate(x + h / 2 * d2, d3, half)
  d4 = v + h * a3;      a4 = rate(x + h * d3, d4, $2)
  x += h / 6 * (d1 + 2 * d2 + 2 * d3 + d4)
  v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
}
{ time = $1; push = $2; printf "%.12g\n", x > out }

function rate(x, v, push) { return (push - c * v - k * x) / m }
