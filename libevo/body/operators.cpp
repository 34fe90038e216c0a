#include "libevo/body/operators.h"
