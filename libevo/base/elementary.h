// Elementary functions whose bits do not depend on the processor. The C
// library picks its tanh, exp, log, ... at run time by instruction set, and the
// variants differ in the last bit; these use only IEEE +, -, *, / and sqrt in
// one order. Errors are below 1 unit in the last place (tanh: 2.5).
#pragma once

namespace evo::math {

double sqrt(double x);  // the IEEE square root
double exp(double x);
double log(double x);
double sin(double x);  // accurate for |x| <= 2^20, as is cos
double cos(double x);
double tanh(double x);
double acos(double x);  // x in [-1, 1]

// The tanh that the benchmark's package gets from the GNU C library where the processor
// has fused operations, to the last bit. What lies on the world's floor leaves the
// reference within 20 control steps with any other; without fused operations, the package
// leaves its own trajectories.
double reference_tanh(double x);

}  // namespace evo::math
