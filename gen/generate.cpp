#include "gen/generate.h"
