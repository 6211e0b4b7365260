// experiments/runs/checkpoint.h — checkpoint file: the state of a run, from which a killed run continues.
//
//   File: one line of text, a check sum of the rest, then the bytes of CheckpointData (integrators/checkpoint.h).
//   Written whole or not at all (core/support/file.h). Throws std::runtime_error, which names the file, if it is not a
//   checkpoint or is damaged.
#pragma once

#include <orthant/integrators/event.h>

#include <filesystem>
#include <string>
#include <vector>

namespace orthant {

struct Checkpoint {
  std::string label;                // what run this is: another one does not go on from it
  std::vector<double> table, last;  // rows recorded so far; the last moment
  std::vector<Event> events;        // located so far
  std::string run;                  // simulate.h, Restart
};

void write_checkpoint(const std::filesystem::path& file, Checkpoint checkpoint);
/// Throws std::runtime_error where another kind of file would be written over.
void check_takes_checkpoint(const std::filesystem::path& file);
Checkpoint read_checkpoint(const std::filesystem::path& file);

}  // namespace orthant
