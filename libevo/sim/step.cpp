#include "libevo/sim/state.h"
