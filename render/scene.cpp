#include "formats/rollout.h"
