#include <orthant/core/lcp/files/io.h>

#include "target.h"

void orthant::fuzz::matrix_market(std::string_view bytes) {
  const MemoryFile file("matrix.mtx", bytes);
  parse([&] { check(read_matrix_market(file.path())); });
  parse([&] { read_matrix_market_vector(file.path()); });
}
