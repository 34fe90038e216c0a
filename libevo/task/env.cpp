#include "libevo/task/env.h"
