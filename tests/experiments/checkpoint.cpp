// A killed simulation goes on from its checkpoint to the file that it would have written; nothing is ever half a file.
#include <doctest/doctest.h>

#include "tests/support/folder.h"

#include <map>

using namespace orthant;

namespace {

struct Runs : Folder {
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
      if (entry.is_regular_file() && entry.path().extension() != ".txt") all[entry.path()] = slurp(entry.path());
    return all;
  }
  static std::string command(const std::string& more, int every = 50) {
    return "'" ORTHANT_CLI "' simulate slider_crank --step 1e-5 --every " + std::to_string(every) + " " + more;
  }
};

}  // namespace

TEST_CASE("killed and resumed, a simulation writes the file that it would have written") {
  const Runs here;
  REQUIRE(here.run(here.command("--checkpoint whole.ckpt --checkpoint-every 700 --output whole.csv")).exit_code == 0);
  const std::string whole = slurp(here.path / "whole.csv");
  REQUIRE(lines(whole) > 300);
  const std::string resumed = here.command("--checkpoint c.ckpt --checkpoint-every 700 --resume --output part.csv");
  int kills = 0;
  for (int i = 1; i <= 40; ++i) {
    const std::string limit = std::to_string(0.02 + 0.01 * i);
    const Reply reply = here.run("timeout --foreground -s KILL " + limit + " " + resumed);
    if (reply.exit_code == 0) break;
    ++kills;
    if (std::filesystem::exists(here.path / "part.csv")) CHECK(slurp(here.path / "part.csv") == whole);
  }
  CHECK(kills > 0);
  // What a kill in the midst of writing leaves: of a process that is no more, the shell of this very line.
  REQUIRE(here.run("sh -c 'echo half > c.ckpt.tmp$$'; echo mine > c.ckpt.tmp1; ls c.ckpt.tmp*").exit_code == 0);
  CHECK(here.run(resumed).exit_code == 0);
  CHECK(slurp(here.path / "part.csv") == whole);
  CHECK(here.run("ls c.ckpt.tmp* | grep -c .").out == "1\n");  // of a process that lives
}

TEST_CASE("a checkpoint of another run, a damaged and a missing one each give a clear error") {
  const Runs here;
  const std::string kept = "--duration 0.01 --checkpoint c.ckpt --checkpoint-every 100 ";
  REQUIRE(here.run(here.command(kept)).exit_code == 0);
  const auto says = [&](const std::string& command, const char* words) {
    const Reply reply = here.run(command);
    INFO(reply.err);
    CHECK(reply.exit_code == 1);
    CHECK(lines(reply.err) == 1);
    CHECK(reply.err.find(words) != std::string::npos);
  };
  says(here.command(kept + "--resume --set mu=0.2"), "is of another run");
  says(here.command(kept + "--resume --solver path"), "is of another run");
  says(here.command(kept + "--resume", 7), "checkpoint: was made with");
  for (const char* same : {"c.ckpt.csv", "./c.ckpt.csv"})
    says(here.command("--checkpoint c.ckpt.csv --output " + std::string(same)),
         ("--checkpoint 'c.ckpt.csv' and --output '" + std::string(same) + "': must be two files").c_str());
  says(here.command("--resume"), "--resume: needs --checkpoint");
  here.write("letter.txt", "keep me");
  says(here.command("--checkpoint letter.txt"), "letter.txt: is no checkpoint, and would be lost");
  CHECK(slurp(here.path / "letter.txt") == "keep me");
  std::string bytes = slurp(here.path / "c.ckpt");
  bytes[bytes.size() / 2] ^= 1;
  here.write("c.ckpt", bytes);
  says(here.command(kept + "--resume"), "damaged checkpoint");
  here.write("c.ckpt", "orthant");
  says(here.command(kept + "--resume"), "is no checkpoint");
}

namespace {

constexpr const char* kFalls = "duration = 0.1\nstep = 1e-3\n[[body]]\nname = 'b'\nmass = 1\ninertia = 1\n";
constexpr const char* kRunsOn = "'" ORTHANT_CLI "' simulate s.toml --checkpoint c.ckpt --checkpoint-every 50 ";

}  // namespace

TEST_CASE("continuing a run reports that the scene's file has changed") {
  const Runs here;
  here.write("s.toml", kFalls);
  REQUIRE(here.run(kRunsOn).exit_code == 0);
  here.write("s.toml", kFalls + std::string("omega = 1\n"));
  const Reply reply = here.run(kRunsOn + std::string("--resume"));
  INFO(reply.err);
  CHECK(reply.exit_code == 1);
  CHECK(reply.err.find("c.ckpt: is of another content of the scene's file (") != std::string::npos);
}

TEST_CASE("a checkpoint that finds no room ends the run, whose trajectory is written") {
  const Runs here;
  here.write("s.toml",
             kFalls + ("#" + std::string(20000, '-')) + "\n");  // a checkpoint holds the text, a trajectory not
  const Reply reply = here.run("trap '' XFSZ; ulimit -f 16; " + std::string(kRunsOn) + "--every 10 --output s.csv");
  INFO(reply.err);
  CHECK(reply.exit_code == 1);
  CHECK(reply.err.find("cannot write") != std::string::npos);
  CHECK(reply.err.find("c.ckpt") != std::string::npos);
  CHECK(lines(slurp(here.path / "s.csv")) == 1 + 6);  // header, start, 5 records in 50 steps
}

TEST_CASE("a full disk leaves the old file, and the run reports it") {
  const Runs here;
  REQUIRE(here.run(here.command("--duration 0.01 --output run.csv")).exit_code == 0);
  const std::string before = slurp(here.path / "run.csv");
  // A file may grow to 4 blocks of 512 bytes here: what a full disk does to a larger one.
  const Reply full = here.run("trap '' XFSZ; ulimit -f 4; " + here.command("--duration 0.05 --output run.csv"));
  INFO(full.err);
  CHECK(full.exit_code != 0);
  CHECK(full.err.find("run.csv") != std::string::npos);
  CHECK(slurp(here.path / "run.csv") == before);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(here.path))
    files += entry.path().string().find("run.csv") != std::string::npos;
  CHECK(files == 1);  // no temporary one is left
  CHECK(here.run(here.command("--duration 0.01 --output /dev/full")).exit_code == 1);
}

TEST_CASE("a result for ParaView is replaced whole or not at all, by a full disk and by a kill") {
  const Runs here;
  const std::string before = here.command("--duration 0.01 --output c.pvd");
  const std::string after = here.command("--duration 0.05 --output c.pvd", 5);  // moments of 3 kB, an index of 60
  REQUIRE(here.run(before).exit_code == 0);
  here.write("c/notes.md", "of somebody else");
  const auto old = here.files();
  REQUIRE(old.size() > 20);

  const Reply full = here.run("trap '' XFSZ; ulimit -f 16; " + after);  // blocks of 512 bytes
  INFO(full.err);
  CHECK(full.exit_code == 1);
  CHECK(full.err.find("c.pvd") != std::string::npos);
  CHECK(here.files() == old);

  CHECK(here.run("ulimit -f 16; ulimit -c 0; " + after).exit_code > 128);  // a signal ends it in the midst of the index
  auto kept = here.files();
  CHECK(kept.size() > old.size());
  std::erase_if(kept, [](const auto& file) { return file.first.find(".tmp") != std::string::npos; });
  CHECK(kept == old);

  REQUIRE(here.run(before).exit_code == 0);
  CHECK(here.files() == old);  // and what the kill left is gone
  REQUIRE(here.run(after).exit_code == 0);
  CHECK(here.files().size() > 1000);
  REQUIRE(here.run(before).exit_code == 0);
  CHECK(here.files() == old);  // the longer one, too
}
