#include "libevo/task/spec.h"
