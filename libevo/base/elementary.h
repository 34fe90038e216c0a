// Elementary functions whose bits do not depend on the processor. The C
// library picks its tanh, exp, log, ... at run time by instruction set, and the
// variants differ in the last bit; these use only IEEE +, -, *, / and sqrt in
// one order, so that scalar code and vector lanes agree everywhere.
#pragma once

namespace evo::math {

double sqrt(double x);  // the IEEE square root
double exp(double x);
double log(double x);
double sin(double x);
double cos(double x);
double tanh(double x);
double acos(double x);  // x in [-1, 1]

}  // namespace evo::math
