#include <orthant/core/lcp/files/io.h>

#include "target.h"

bool orthant::fuzz::matrix_market(std::string_view bytes) {
  const MemoryFile file("matrix.mtx", bytes);
  const bool matrix = parse([&] { check(read_matrix_market(file.path())); });
  const bool vector = parse([&] { read_matrix_market_vector(file.path()); });
  return matrix || vector;
}
