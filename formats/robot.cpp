#include "formats/robot.h"
