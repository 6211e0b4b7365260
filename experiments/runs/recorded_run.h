// experiments/runs/recorded_run.h — a run as its trajectory file holds it: CSV or HDF5 (trajectory_files.h), read.
#pragma once

#include "experiments/runs/pushes.h"

#include <filesystem>
#include <string>
#include <vector>

namespace orthant {

struct RecordedEvent {
  double t = 0;
  std::string kind, contact;
  double normal = 0, tangent = 0;  // impulses [N s]
};

struct RecordedRun {
  std::vector<std::string> columns;  // t first
  std::vector<double> table;         // row by row
  std::vector<RecordedEvent> events;
  std::string drawing;            // JSON (drawing.h) of an HDF5 file; empty: none
  std::vector<Push> pushes = {};  // of searched collisions, in order of time; no file holds them

  std::size_t rows() const { return table.size() / columns.size(); }
};

/// By the name's end: .csv (its events from NAME.events.csv, where that is there), .h5 or .hdf5. Throws
/// std::runtime_error naming file, line or data set, and rule; std::invalid_argument for another end.
RecordedRun read_run(const std::filesystem::path& file);

/// Whether the name ends as a file that read_run takes.
bool is_recorded_run(const std::filesystem::path& file);

}  // namespace orthant
