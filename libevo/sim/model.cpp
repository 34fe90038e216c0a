#include "libevo/sim/model.h"
