// orthant — the program; its commands are in command.cpp.
#include "experiments/cli/command.h"

int main(int argc, char** argv) { return orthant::run_command(argc, argv); }
