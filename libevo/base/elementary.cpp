#include "libevo/base/elementary.h"

#include <cmath>

namespace evo::math {

double sqrt(double x) { return std::sqrt(x); }
double exp(double x) { return std::exp(x); }
double log(double x) { return std::log(x); }
double sin(double x) { return std::sin(x); }
double cos(double x) { return std::cos(x); }
double tanh(double x) { return std::tanh(x); }
double acos(double x) { return std::acos(x); }

}  // namespace evo::math
