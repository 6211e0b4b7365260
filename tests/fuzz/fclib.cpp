#include <orthant/core/lcp/files/io_fclib.h>

#include "target.h"

void orthant::fuzz::fclib(std::string_view bytes) {
  const MemoryFile file("contacts.hdf5", bytes);
  parse([&] { check(read_fclib(file.path()).problem); });
}
