#include "experiments/sweep/results.h"

#include "experiments/runs/manifest.h"

#include <orthant/core/support/shortened.h>
#include <orthant/integrators/run_fields.h>

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <map>
#include <stdexcept>
#include <thread>

namespace orthant {
namespace {

constexpr int kOurs = 0x6f727468, kVersion = 4;  // "orth"; both stand in the file's head

constexpr Column kFirst[] = {
    {"key", "TEXT PRIMARY KEY"}, {"scene", "TEXT"},         {"parameters", "TEXT"}, {"integrator", "TEXT"},
    {"solver", "TEXT"},          {"step", "REAL"},          {"rtol", "REAL"},       {"duration", "REAL"},
    {"measure", "TEXT"},         {"compared_with", "TEXT"}, {"repeats", "INTEGER"}, {"time_limit", "REAL"},
    {"revision", "TEXT"},        {"status", "TEXT"},        {"why", "TEXT"},        {"value", "REAL"},
    {"reference", "REAL"},       {"error", "REAL"},
};
constexpr Column kLast[] = {
    {"energy_drift", "REAL"},     {"momentum_drift", "REAL"}, {"spin_drift", "REAL"},    {"impulse", "REAL"},
    {"friction_impulse", "REAL"}, {"first_touch", "REAL"},    {"first_release", "REAL"}, {"last_release", "REAL"},
    {"touching", "REAL"},         {"problem", "TEXT"},        {"slowest", "REAL"},       {"seconds", "REAL"},
};

/// The fields of a run stand between the two; "seconds" is the last column, measured as the case says.
std::vector<Column> make_columns() {
  std::vector<Column> columns(std::begin(kFirst), std::end(kFirst));
  Run run;
  visit_fields(run, [&](const char* field, const char*, const char*, auto& value) {
    if (field != std::string_view("seconds"))
      columns.push_back({field, std::is_same_v<decltype(value), long&> ? "INTEGER" : "REAL"});
  });
  columns.insert(columns.end(), std::begin(kLast), std::end(kLast));
  return columns;
}

std::string list_of_columns(const char* separator, bool types) {
  std::string text;
  for (const Column& column : columns_of_cases())
    text += (text.empty() ? "" : separator) + std::string(column.name) + (types ? std::string(" ") + column.type : "");
  return text;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

/// Reading also makes files next to the database, for its write-ahead log. Where none can be made and there is no
/// log, nobody writes: SQLite may then take the file for what never changes. Source: https://sqlite.org/uri.html
bool fixed(const std::filesystem::path& file) {
  std::error_code none;
  return access(folder_of(file).c_str(), W_OK) != 0 && std::filesystem::is_regular_file(file, none) &&
         !std::filesystem::exists(file.string() + "-wal", none);
}

/// Bytes, but fewer than SQLite's smallest page: it takes them for no bytes.
bool is_scrap(const std::filesystem::path& file) {
  std::error_code none;
  const std::uintmax_t bytes = std::filesystem::file_size(file, none);
  return !none && bytes > 0 && bytes < 512;
}

std::string uri_of(const std::filesystem::path& file) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(file).string())
    uri += c == '%' ? "%25" : c == '?' ? "%3f" : c == '#' ? "%23" : std::string(1, c);
  return uri + "?immutable=1";
}

/// Rows as they are written have these; some readers ask no more.
bool always_there(std::string_view column) {
  for (const char* each :
       {"key", "scene", "parameters", "integrator", "solver", "step", "duration", "measure", "status"})
    if (column == each) return true;
  return false;
}

/// Why it is no row that a sweep writes; empty: it is one.
std::string fault_of(const ResultRow& row) {
  for (const Column& column : columns_of_cases()) {
    if (!row.contains(column.name)) return std::string("it has no column ") + column.name;
    const auto& value = row.at(column.name);
    const bool text = column.type[0] == 'T';
    if (value.is_null() ? always_there(column.name) : text ? !value.is_string() : !value.is_number())
      return std::string("a row whose ") + column.name + " is no " + (text ? "text" : "number");
  }
  const auto key = row.at("key").get<std::string>();  // files are named so
  if (key.empty() || key.size() > 16 || key.find_first_not_of("0123456789abcdef") != std::string::npos)
    return "a row whose key is none";
  try {
    row.dump();  // UTF-8
    if (!ResultRow::parse(row.at("parameters").get<std::string>()).is_object()) return "a row without parameters";
  } catch (const nlohmann::json::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace

std::span<const Column> columns_of_cases() {
  static const std::vector<Column> columns = make_columns();
  return columns;
}

/// One prepared statement: bind, step, read.
class Results::Statement {
 public:
  Statement(const Results& results, const std::string& sql) : results_(results) {
    if (sqlite3_prepare_v2(results.db_, sql.c_str(), -1, &statement_, nullptr) != SQLITE_OK) results.fail("read");
  }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  ~Statement() { sqlite3_finalize(statement_); }

  Statement& bind(const nlohmann::ordered_json& value) {
    ++bound_;
    if (value.is_null())
      sqlite3_bind_null(statement_, bound_);
    else if (value.is_string())
      sqlite3_bind_text(statement_, bound_, value.get_ref<const std::string&>().c_str(), -1, SQLITE_TRANSIENT);
    else if (value.is_number_float())
      sqlite3_bind_double(statement_, bound_, value.get<double>());
    else
      sqlite3_bind_int64(statement_, bound_, value.get<std::int64_t>());
    return *this;
  }
  bool step() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) results_.fail("use");
    return code == SQLITE_ROW;
  }
  nlohmann::ordered_json at(int i) const {
    switch (sqlite3_column_type(statement_, i)) {
      case SQLITE_INTEGER:
        return static_cast<std::int64_t>(sqlite3_column_int64(statement_, i));
      case SQLITE_FLOAT:
        return sqlite3_column_double(statement_, i);
      case SQLITE_TEXT:
        return reinterpret_cast<const char*>(sqlite3_column_text(statement_, i));
      default:
        return nullptr;
    }
  }
  ResultRow row() const {
    ResultRow row;
    for (int i = 0; i < sqlite3_column_count(statement_); ++i) row[sqlite3_column_name(statement_, i)] = at(i);
    return row;
  }

 private:
  const Results& results_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

void Results::fail(const std::string& what) const {
  std::string reason = db_ != nullptr ? sqlite3_errmsg(db_) : "out of memory";
  std::error_code unknown;
  const auto kind = std::filesystem::status(file_, unknown).type();
  switch (db_ != nullptr ? sqlite3_errcode(db_) & 0xff : 0) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      reason = "another program has locked it and does not let go";
      break;
    case SQLITE_FULL:
      reason = "the disk is full";
      break;
    case SQLITE_IOERR:
      if (kind == std::filesystem::file_type::directory)
        reason = "it is a folder";
      else if (kind != std::filesystem::file_type::regular)
        reason = "it is no regular file";
      else
        reason += " (is the disk full?)";
      break;
    case SQLITE_READONLY:
      reason = "it, or its folder, is read-only";
      break;
    case SQLITE_CANTOPEN:
      if (access(folder_of(file_).c_str(), W_OK) != 0)
        reason += " (its folder: " + std::string(std::strerror(errno)) + ")";
      else if (kind == std::filesystem::file_type::none)
        reason += " (" + unknown.message() + ")";
      break;
    case SQLITE_NOTADB:
      reason = "it is no results file";
      break;
    case SQLITE_CORRUPT:
      damaged(reason);
    default:
      break;
  }
  throw std::runtime_error("cannot " + what + " " + file_.string() + ": " + reason);
}

void Results::damaged(const std::string& what) const {
  throw std::runtime_error("cannot read " + file_.string() + ": it is damaged: " + shortened(what, 300));
}

void Results::run(const std::string& sql) const {
  if (sqlite3_exec(db_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail("write");
}

Results::Results(const std::filesystem::path& file, Open open, double patience) : file_(file) {
  std::error_code none;
  if (std::filesystem::exists(file, none) && !std::filesystem::is_regular_file(file, none))
    throw std::runtime_error("cannot use " + file.string() + ": it is " +
                             (std::filesystem::is_directory(file, none) ? "a folder" : "no regular file"));
  const int flags = open == read_only ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  try {
    const bool alone = open == read_only && fixed(file);
    if (sqlite3_open_v2(alone ? uri_of(file).c_str() : file.c_str(), &db_, flags | (alone ? SQLITE_OPEN_URI : 0),
                        nullptr) != SQLITE_OK)
      fail("open");
    if (open == read_write && sqlite3_db_readonly(db_, "main") == 1)
      throw std::runtime_error("cannot write " + file.string() + ": it, or its folder, is read-only");
    sqlite3_busy_timeout(db_, static_cast<int>(1e3 * patience));
    const auto pragma = [&](const char* name) {
      Statement statement(*this, std::string("PRAGMA ") + name);
      return statement.step() ? statement.at(0).get<int>() : 0;
    };
    run("BEGIN");  // one moment for all three: another process may be making the file
    const int id = pragma("application_id"), version = pragma("user_version"), schema = pragma("schema_version");
    run("COMMIT");
    if (id == kOurs) {
      if (version != kVersion) throw std::runtime_error(file.string() + ": was written by another version of orthant");
    } else if (id == 0 && open == read_only && schema == 0 && !is_scrap(file)) {
      throw std::runtime_error("cannot use " + file.string() + ": it is empty, no sweep has written to it yet");
    } else if (id != 0 || open == read_only || schema != 0) {
      throw std::runtime_error("cannot use " + file.string() + ": it is no results file");
    }
    if (open == read_only) return;
    // The one lock that SQLite does not wait for by itself: two processes that begin a file together both ask for it.
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience);
    while (sqlite3_exec(db_, "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr) != SQLITE_OK) {
      if ((sqlite3_errcode(db_) & 0xff) != SQLITE_BUSY || std::chrono::steady_clock::now() >= end) fail("write");
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    run("PRAGMA synchronous = NORMAL");
    run("BEGIN IMMEDIATE; CREATE TABLE IF NOT EXISTS cases(" + list_of_columns(", ", true) +
        "); CREATE TABLE IF NOT EXISTS sweeps(name TEXT PRIMARY KEY, about TEXT);"
        "CREATE TABLE IF NOT EXISTS members(sweep TEXT, place INTEGER, key TEXT, PRIMARY KEY(sweep, place));"
        "PRAGMA application_id = " +
        std::to_string(kOurs) + "; PRAGMA user_version = " + std::to_string(kVersion) + "; COMMIT");
  } catch (...) {
    sqlite3_close(db_);
    throw;
  }
}

Results::~Results() { sqlite3_close(db_); }

void Results::forget_undecided(const Sweep& sweep, bool retry) {
  std::map<std::string, bool> asked_again;  // of the runs that others are compared with
  const auto undecided = [&](const Case& c) {
    const auto row = find(c.key());
    if (!row || row->at("status") == "solved") return false;
    if (row->at("status") == "crashed") return retry;
    if (row->at("status") != "time_limit") return false;
    const auto& limit = row->at("time_limit");
    return retry || limit.is_null() || limit.get<double>() < c.time_limit;
  };
  const auto forget = [&](const std::string& key) {
    Statement(*this, "DELETE FROM cases WHERE key = ?").bind(key).step();
  };
  for (const Case& other : sweep.reference_cases())
    if ((asked_again[other.key()] = undecided(other))) forget(other.key());
  for (const Case& c : sweep.cases) {
    const auto other = c.reference_case();
    if (undecided(c) || (other && asked_again[other->key()])) forget(c.key());
  }
}

void Results::declare(const Sweep& sweep, bool retry) {
  nlohmann::ordered_json about = manifest();
  about.erase("written");
  about["question"] = sweep.question, about["scene"] = sweep.scene, about["page"] = sweep.page;
  if (!sweep.scene_text.empty()) about["scene_text"] = sweep.scene_text;
  run("BEGIN IMMEDIATE");
  try {
    forget_undecided(sweep, retry);
    Statement(*this, "REPLACE INTO sweeps VALUES(?, ?)").bind(sweep.name).bind(about.dump()).step();
    Statement(*this, "DELETE FROM members WHERE sweep = ?").bind(sweep.name).step();
    for (std::size_t i = 0; i < sweep.cases.size(); ++i)
      Statement(*this, "INSERT INTO members VALUES(?, ?, ?)")
          .bind(sweep.name)
          .bind(i)
          .bind(sweep.cases[i].key())
          .step();
    run("COMMIT");
  } catch (...) {
    sqlite3_exec(db_, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

bool Results::has(const std::string& key) const {
  return Statement(*this, "SELECT 1 FROM cases WHERE key = ?").bind(key).step();
}

void Results::add(const ResultRow& row) {
  ResultRow whole = row;
  for (const Column& column : columns_of_cases())
    if (!whole.contains(column.name)) whole[column.name] = nullptr;
  if (const std::string fault = fault_of(whole); !fault.empty())
    throw std::invalid_argument("no row of a sweep: " + fault);
  std::string places;
  for (std::size_t i = 0; i < columns_of_cases().size(); ++i) places += i == 0 ? "?" : ", ?";
  Statement statement(*this,
                      "INSERT OR IGNORE INTO cases(" + list_of_columns(", ", false) + ") VALUES(" + places + ")");
  for (const Column& column : columns_of_cases()) statement.bind(whole.at(column.name));
  statement.step();
}

std::optional<ResultRow> Results::find(const std::string& key) const {
  Statement statement(*this, "SELECT * FROM cases WHERE key = ?");
  if (!statement.bind(key).step()) return {};
  return checked(statement.row());
}

ResultRow Results::checked(ResultRow row) const {
  if (const std::string fault = fault_of(row); !fault.empty()) damaged(fault);
  return row;
}

std::vector<Results::Declared> Results::sweeps() const {
  std::vector<Declared> all;
  try {
    for (Statement s(*this, "SELECT name, about FROM sweeps ORDER BY name"); s.step();) {
      all.push_back({s.at(0).get<std::string>(), nlohmann::ordered_json::parse(s.at(1).get<std::string>())});
      nlohmann::ordered_json(all.back().name).dump();  // UTF-8
      for (const char* key : {"question", "scene"}) all.back().about.at(key).get_ref<const std::string&>();
    }
  } catch (const nlohmann::json::exception& error) {
    damaged(error.what());
  }
  return all;
}

std::vector<ResultRow> Results::rows(const std::string& sweep) const {
  std::vector<ResultRow> all;
  Statement statement(*this, "SELECT cases.* FROM members JOIN cases USING(key) WHERE sweep = ? ORDER BY place");
  for (statement.bind(sweep); statement.step();) all.push_back(checked(statement.row()));
  return all;
}

long Results::members(const std::string& sweep) const {
  Statement statement(*this, "SELECT count(*) FROM members WHERE sweep = ?");
  statement.bind(sweep).step();
  return statement.at(0).get<long>();
}

namespace {

struct flock byte_of(const std::string& key, short kind) {
  struct flock lock {};
  lock.l_type = kind, lock.l_whence = SEEK_SET, lock.l_len = 1;
  lock.l_start = static_cast<off_t>(std::stoull(key, nullptr, 16) >> 2);
  return lock;
}

}  // namespace

Claims::Claims(const std::filesystem::path& results)
    : file_(open((results.string() + "-claims").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  if (file_ < 0) throw std::runtime_error("cannot write " + results.string() + "-claims: " + std::strerror(errno));
}

Claims::~Claims() { close(file_); }

bool Claims::take(const std::string& key) {
  struct flock lock = byte_of(key, F_WRLCK);
  return fcntl(file_, F_OFD_SETLK, &lock) == 0;
}

void Claims::release(const std::string& key) {
  struct flock lock = byte_of(key, F_UNLCK);
  fcntl(file_, F_OFD_SETLK, &lock);
}

}  // namespace orthant
