#include "libevo/body/body.h"
