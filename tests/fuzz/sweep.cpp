#include "experiments/sweep/sweep.h"

#include "target.h"

void orthant::fuzz::sweep(std::string_view bytes) {
  const MemoryFile file("x.sweep.toml", bytes);
  for (const bool quick : {false, true}) parse([&] { read_sweep(file.path(), quick); });
}
