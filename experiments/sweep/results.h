// experiments/sweep/results.h — results file: the results of sweeps in one SQLite file; a row a case, by key.
//
//   cases(key, …)           columns_of_cases(): the case, then its result; only "seconds" differs from run to run
//   sweeps(name, about)     the definition, the build and the machine, as JSON
//   members(sweep, place, key)   which cases a sweep has, in its order; a case may be in several
// A case that a time limit or a crash ended runs again with more time, or with `retry`: declare().
// Write-ahead log, one transaction per case: a sweep killed at any time keeps its written rows, and resumes with the
// missing cases (run.h). Several processes may write.
// Source of the guarantees: https://sqlite.org/wal.html, https://sqlite.org/atomiccommit.html. Not on network drives.
#pragma once

#include "experiments/sweep/sweep.h"

#include <filesystem>
#include <memory>

struct sqlite3;
struct sqlite3_stmt;

namespace orthant {

struct Column {
  const char *name, *type;
};
/// The columns of a row, in order.
std::span<const Column> columns_of_cases();

class Results {
 public:
  enum Open { read_only, read_write };
  /// Throws std::runtime_error naming file and reason: no database, not ours, locked for longer than `patience` [s],
  /// disk full, not to be written, damaged. So does everything below. Read only, it may lie on a read-only disk.
  explicit Results(const std::filesystem::path& file, Open open = read_write, double patience = 10);
  Results(const Results&) = delete;
  Results& operator=(const Results&) = delete;
  ~Results();

  /// Definition and build. Forgets the rows of its cases that a shorter time limit than now ended, or with `retry` any
  /// limit or a crash, and those that were compared with such runs: they are missing then.
  void declare(const Sweep& sweep, bool retry = false);
  bool has(const std::string& key) const;
  /// A row that is there already stays as it is.
  void add(const ResultRow& row);
  /// Of a case that is there.
  std::optional<ResultRow> find(const std::string& key) const;

  struct Declared {
    std::string name;
    nlohmann::ordered_json about;
  };
  std::vector<Declared> sweeps() const;
  /// Of one sweep in its order, as far as they are done; parameters as one JSON text.
  std::vector<ResultRow> rows(const std::string& sweep) const;
  long members(const std::string& sweep) const;

 private:
  class Statement;
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void damaged(const std::string& what) const;
  /// The row, if it can have been written by add(): readers rely on its columns, and the file may be anybody's.
  ResultRow checked(ResultRow row) const;
  void run(const std::string& sql) const;
  void forget_undecided(const Sweep& sweep, bool retry);
  std::filesystem::path file_;
  sqlite3* db_ = nullptr;
};

/// Claims a case for one of the processes of this machine: a lock on one byte of a file next to the
/// results, which the system takes away when its owner dies. Source: fcntl(2), open file description locks.
class Claims {
 public:
  explicit Claims(const std::filesystem::path& results);
  Claims(const Claims&) = delete;
  Claims& operator=(const Claims&) = delete;
  ~Claims();
  bool take(const std::string& key);
  void release(const std::string& key);

 private:
  int file_;
};

}  // namespace orthant
