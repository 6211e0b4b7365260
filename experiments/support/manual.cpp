#include "experiments/support/manual.h"

#include <algorithm>
#include <sstream>

namespace orthant {
namespace {

/// Text that troff does not take for its own.
std::string quoted_for_troff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n'))
      out += "\\&" + std::string(1, c);
    else
      out += c;
  }
  return out;
}

void write_option(std::ostream& out, const CLI::Option& option) {
  std::string names, value;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
  for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ", --") + name;
  if (names.empty()) names = option.get_name();
  if (option.get_items_expected_max() != 0 && option.get_positional() == false) value = option.get_type_name();
  out << ".TP\n\\fB" << quoted_for_troff(names) << "\\fR";
  if (!value.empty()) out << " \\fI" << quoted_for_troff(value) << "\\fR";
  out << '\n' << quoted_for_troff(option.get_description());
  if (!option.get_default_str().empty()) out << " (default: " << quoted_for_troff(option.get_default_str()) << ')';
  out << '\n';
}

std::string name_of(const CLI::App& command) {
  return command.get_parent() == nullptr ? "orthant" : "orthant-" + command.get_name();
}

}  // namespace

std::string manual_page(const CLI::App& command, const std::string& version, const std::string& date) {
  std::ostringstream out;
  std::string capitals = name_of(command);
  std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  const bool whole = command.get_parent() == nullptr;
  out << ".TH " << quoted_for_troff(capitals) << " 1 " << date << " \"Orthant " << version << "\" \"Orthant\"\n"
      << ".SH NAME\n"
      << quoted_for_troff(name_of(command)) << " \\- " << quoted_for_troff(command.get_description()) << '\n'
      << ".SH SYNOPSIS\n\\fB"
      << (whole ? "orthant\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]" : "orthant " + command.get_name() + "\\fR");
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional() && option->get_lnames().empty())
      out << (option->get_required() ? " \\fI" : " [\\fI") << quoted_for_troff(option->get_name())
          << (option->get_required() ? "\\fR" : "\\fR]");
  out << (whole ? "\n" : " [\\fIOPTIONS\\fR]\n");
  if (whole) {
    out << ".SH COMMANDS\n";
    for (const CLI::App* sub : command.get_subcommands(nullptr))
      out << ".TP\n\\fB" << sub->get_name() << "\\fR\n" << quoted_for_troff(sub->get_description()) << '\n';
  }
  out << ".SH OPTIONS\n";
  for (const CLI::Option* option : command.get_options()) write_option(out, *option);
  if (const std::string footer = command.get_footer(); !footer.empty())
    out << ".SH NOTES\n.nf\n" << quoted_for_troff(footer) << "\n.fi\n";
  if (whole) {
    out << ".SH SEE ALSO\n";
    std::string list;
    for (const CLI::App* sub : command.get_subcommands(nullptr))
      list += (list.empty() ? "\\fB" : ",\n\\fB") + quoted_for_troff(name_of(*sub)) + "\\fR(1)";
    out << list << '\n';
  } else {
    out << ".SH SEE ALSO\n\\fBorthant\\fR(1)\n";
  }
  return out.str();
}

}  // namespace orthant
