#include "experiments/runs/recorded_run.h"

#include "experiments/runs/event_table.h"
#include "experiments/support/printable.h"

#include <orthant/core/lcp/files/hdf5_input.h>
#include <orthant/core/support/file.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace orthant {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestRun = std::uintmax_t{4} << 30;  // [bytes]

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

/// Calls each line but the first, which it returns split, with its cells and its number.
template <class OnLine> std::vector<std::string_view> visit_csv(std::string_view text, OnLine&& on_line) {
  std::vector<std::string_view> head;
  for (std::size_t begin = 0, number = 1; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (number == 1)
      head = split(line);
    else if (!line.empty())
      on_line(head, split(line), number);
    begin = end + 1;
  }
  return head;
}

class CsvFile {
 public:
  explicit CsvFile(const fs::path& file) : name_(file.string()), text_(read_whole(file, largest_input(kLargestRun))) {}

  [[noreturn]] void refuse(std::size_t line, const std::string& rule) const {
    throw std::runtime_error(name_ + ", line " + std::to_string(line) + ": " + rule);
  }
  double number(std::string_view cell, std::size_t line) const {
    double x = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), x);
    if (error != std::errc() || end != cell.data() + cell.size())
      refuse(line, "must hold numbers, separated by commas");
    return x;
  }
  const std::string& text() const { return text_; }

 private:
  std::string name_, text_;
};

std::vector<RecordedEvent> read_events(const fs::path& file) {
  std::vector<RecordedEvent> events;
  if (!fs::exists(file)) return events;
  const CsvFile csv(file);
  visit_csv(csv.text(), [&](const auto&, const auto& cells, std::size_t line) {
    if (cells.size() != 5) csv.refuse(line, "must be t,kind,contact,impulse_n,impulse_t");
    events.push_back({csv.number(cells[0], line), std::string(cells[1]), std::string(cells[2]),
                      csv.number(cells[3], line), csv.number(cells[4], line)});
  });
  return events;
}

RecordedRun read_csv(const fs::path& file) {
  RecordedRun run;
  const CsvFile csv(file);
  const auto head = visit_csv(csv.text(), [&](const auto& columns, const auto& cells, std::size_t line) {
    if (cells.size() != columns.size())
      csv.refuse(line, "has " + std::to_string(cells.size()) + " cells: must have " + std::to_string(columns.size()));
    for (const std::string_view cell : cells) run.table.push_back(csv.number(cell, line));
  });
  run.columns.assign(head.begin(), head.end());
  run.events = read_events(events_file_of(file));
  return run;
}

std::string name_at(const std::vector<std::string_view>& names, double place) {
  const bool good = place >= 0 && place < static_cast<double>(names.size());
  return good ? std::string(names[static_cast<std::size_t>(place)]) : "?";
}

RecordedRun read_hdf5(const fs::path& file) {
  const Hdf5Input input(file);
  RecordedRun run;
  run.columns = input.arrays();
  if (const auto t = std::find(run.columns.begin(), run.columns.end(), "t"); t != run.columns.end())
    std::rotate(run.columns.begin(), t, t + 1);
  std::vector<std::vector<double>> values;
  for (const std::string& column : run.columns) {
    values.push_back(input.numbers(column));
    if (values.back().size() != values.front().size())
      throw std::runtime_error(file.string() + ": " + column + " has " + std::to_string(values.back().size()) +
                               " entries: must have " + std::to_string(values.front().size()) + ", as t");
  }
  for (std::size_t i = 0; !values.empty() && i < values.front().size(); ++i)
    for (const auto& column : values) run.table.push_back(column[i]);
  if (input.has("scene/drawing")) run.drawing = input.text("scene/drawing");
  if (!input.has("events")) return run;
  const auto t = input.numbers("events/t"), kind = input.numbers("events/kind"),
             contact = input.numbers("events/contact"), normal = input.numbers("events/impulse_n"),
             tangent = input.numbers("events/impulse_t");
  const std::string kinds = input.text("events/kinds"), contacts = input.text("events/contacts");
  const auto kind_names = split(kinds), contact_names = split(contacts);
  if (std::min({kind.size(), contact.size(), normal.size(), tangent.size()}) < t.size())
    throw std::runtime_error(file.string() + ": events: the arrays must be as long as events/t");
  for (std::size_t i = 0; i < t.size(); ++i)
    run.events.push_back(
        {t[i], name_at(kind_names, kind[i]), name_at(contact_names, contact[i]), normal[i], tangent[i]});
  return run;
}

/// Files of strangers: names are text and differ, time does not run back.
void require_sound(RecordedRun& run, const std::string& file) {
  std::set<std::string> seen;
  for (std::string& column : run.columns) {
    column = printable(column);
    if (!seen.insert(column).second) throw std::runtime_error(file + ": column " + column + ": is there twice");
  }
  for (RecordedEvent& event : run.events) event.kind = printable(event.kind), event.contact = printable(event.contact);
  double before = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < run.rows(); ++i) {
    const double t = run.table[i * run.columns.size()];
    if (!std::isfinite(t) || t < before)
      throw std::runtime_error(file + ": row " + std::to_string(i + 1) + ": t must be finite and must not run back");
    before = t;
  }
}

}  // namespace

bool is_recorded_run(const fs::path& file) {
  const fs::path end = file.extension();
  return end == ".csv" || end == ".h5" || end == ".hdf5";
}

RecordedRun read_run(const fs::path& file) {
  if (!is_recorded_run(file)) throw std::invalid_argument(file.string() + ": must end in .csv, .h5 or .hdf5");
  RecordedRun run = file.extension() == ".csv" ? read_csv(file) : read_hdf5(file);
  if (run.columns.empty() || run.columns.front() != "t" || run.table.empty())
    throw std::runtime_error(file.string() + ": must be a trajectory: a column t and others, with a row at least");
  require_sound(run, file.string());
  return run;
}

}  // namespace orthant
