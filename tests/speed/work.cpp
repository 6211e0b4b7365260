// work            the names of watched work, with the units of a short run and a longer one
// work NAME N     does N units of it: for tests/instructions, which counts what that takes
#include <cstdlib>
#include <iostream>
#include <string>

#include "tests/support/work.h"

int main(int argc, char** argv) try {
  for (const orthant::Work& work : orthant::watched_work()) {
    if (argc != 3)
      std::cout << work.name << ',' << work.unit << ',' << work.least << ',' << work.more << '\n';
    else if (work.name == argv[1])
      work.make()(std::atol(argv[2]));
  }
} catch (const std::exception& error) {
  std::cerr << "work: " << error.what() << '\n';
  return 1;
}
