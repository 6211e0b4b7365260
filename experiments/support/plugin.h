// experiments/support/plugin.h — plugins: shared libraries that register solvers, integrators and scenes of their own.
//
//   extern "C" void orthant_plugin() { orthant::register_solver<Mine>("mine", "what it is"); }
//   c++ -std=c++20 -shared -fPIC -I PREFIX/include mine.cpp -o mine.so       orthant --plugin ./mine.so solve …
// A plugin is compiled with the headers of the same Orthant, and linked with none of its libraries: it uses the code
// of the program that loads it.
#pragma once

#include <filesystem>

namespace orthant {

/// Loads it, for as long as the process lives. Throws std::invalid_argument naming file and rule.
void load_plugin(const std::filesystem::path& file);

}  // namespace orthant
