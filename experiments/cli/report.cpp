// orthant report — results of sweeps as one HTML page.
#include "experiments/cli/commands.h"

#include "experiments/report/report.h"
#include "experiments/support/status_line.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/shortened.h>

#include <iostream>

namespace orthant {

void add_report(CLI::App& app, int& exit_code) {
  struct Arguments {
    std::string results, output = "report.html";
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("report", "Results of orthant sweep as one HTML page that needs nothing else");
  command->add_option("results", arguments->results, "SQLite file")->required();
  command->add_option("--output", arguments->output, "the page")->capture_default_str();
  command->add_flag("--json", arguments->json, "where it is, as one JSON object");
  command->footer(
      "Exit codes: 0 done, 1 bad input.\n"
      "Example:\n"
      "  orthant report mine.sqlite --output mine.html");
  command->callback([arguments, &exit_code] {
    check_apart("--output", arguments->output, "the results", arguments->results);
    check_writable(arguments->output);
    try {
      with_elapsed_line("report", [&] {
        write_whole(arguments->output, page(report_data(Results(arguments->results, Results::read_only))));
      });
    } catch (const nlohmann::json::exception& error) {
      throw std::runtime_error("cannot read " + arguments->results +
                               ": it is damaged: " + shortened(error.what(), 300));
    }
    if (arguments->json)
      std::cout << nlohmann::json{{"report", arguments->output}}.dump() << '\n';
    else
      std::cout << "report: " << arguments->output << '\n';
    exit_code = 0;
  });
}

}  // namespace orthant
