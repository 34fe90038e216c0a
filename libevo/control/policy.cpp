#include "libevo/control/policy.h"
