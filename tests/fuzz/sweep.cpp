#include "experiments/sweep/sweep.h"

#include "target.h"

bool orthant::fuzz::sweep(std::string_view bytes) {
  const MemoryFile file("x.sweep.toml", bytes);
  bool accepted = false;
  for (const bool quick : {false, true}) accepted |= parse([&] { read_sweep(file.path(), quick); });
  return accepted;
}
