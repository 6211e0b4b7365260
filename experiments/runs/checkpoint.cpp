#include "experiments/runs/checkpoint.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/hash.h>
#include <orthant/integrators/checkpoint.h>

#include <cstdint>
#include <fstream>

namespace orthant {
namespace {

constexpr std::string_view kMagic = "orthant checkpoint 2\n", kStart = kMagic.substr(0, 19);  // of any version

void remember(Checkpoint& c, CheckpointData& memory) { memory(c.label, c.table, c.last, c.events, c.run); }

}  // namespace

void write_checkpoint(const std::filesystem::path& file, Checkpoint checkpoint) {
  CheckpointData body, sum;
  remember(checkpoint, body);
  std::uint64_t check = fnv1a(body.bytes());
  sum(check);
  write_whole(file, std::string(kMagic) + sum.bytes() + body.bytes());
}

void check_takes_checkpoint(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string start(kMagic.size(), '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  if (!start.starts_with(kStart.substr(0, start.size())))
    throw std::runtime_error(file.string() + ": is no checkpoint, and would be lost: must be one, or not there yet");
}

Checkpoint read_checkpoint(const std::filesystem::path& file) {
  const std::string text = read_whole(file, largest_input(UINTMAX_MAX));  // our own: as long as its run
  std::string_view left = text;
  std::uint64_t check = 0;
  if (!left.starts_with(kMagic) || left.size() < kMagic.size() + sizeof check)
    throw std::runtime_error(file.string() + ": is no checkpoint of this version");
  left.remove_prefix(kMagic.size());
  CheckpointData(left.substr(0, sizeof check))(check);
  left.remove_prefix(sizeof check);
  if (fnv1a(left) != check)
    throw std::runtime_error(file.string() + ": is a damaged checkpoint: its check sum differs");
  Checkpoint checkpoint;
  CheckpointData memory(left);
  remember(checkpoint, memory);
  memory.end();
  return checkpoint;
}

}  // namespace orthant
