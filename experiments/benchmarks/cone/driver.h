// experiments/benchmarks/cone/driver.h — driver base of rivals on contact problems with friction discs: as of LCPs.
#pragma once

#include "../lcp/driver.h"
