// tests/support/judge.h — the second judge, shared with the experiments.
#pragma once

#include "experiments/studies/support/independent_judge.h"
