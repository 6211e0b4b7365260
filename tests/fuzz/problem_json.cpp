#include <orthant/core/lcp/files/io.h>

#include "target.h"

bool orthant::fuzz::problem_json(std::string_view bytes) {
  return parse([&] {
    const Lcp problem = parse_problem(bytes);
    if (const std::string text = to_json(problem); to_json(parse_problem(text)) != text)
      broken("what is read can be written and read again", text);
  });
}
