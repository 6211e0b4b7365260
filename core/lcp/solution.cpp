#include <orthant/core/lcp/solution.h>

#include <cmath>
#include <sstream>

namespace orthant {

std::string_view name(Status status) {
  switch (status) {
    case Status::not_run:
      return "not_run";
    case Status::solved:
      return "solved";
    case Status::rounded:
      return "rounded";
    case Status::infeasible:
      return "infeasible";
    case Status::ray:
      return "ray";
    case Status::iteration_limit:
      return "iteration_limit";
    case Status::time_limit:
      return "time_limit";
    case Status::cancelled:
      return "cancelled";
    case Status::stalled:
      return "stalled";
    case Status::unsupported:
      return "unsupported";
    case Status::numerical_error:
      return "numerical_error";
  }
  return "not_run";
}

Status status_of(Claim claim) {
  switch (claim) {
    case Claim::ray:
    case Claim::exhausted:
      return Status::ray;
    case Claim::iteration_limit:
      return Status::iteration_limit;
    case Claim::time_limit:
      return Status::time_limit;
    case Claim::cancelled:
      return Status::cancelled;
    case Claim::unsupported:
      return Status::unsupported;
    case Claim::numerical_error:
      return Status::numerical_error;
    case Claim::candidate:
    case Claim::stalled:
      break;
  }
  return Status::stalled;
}

std::string why(const Solution& s) {
  if (s.status == Status::solved || s.status == Status::not_run || s.status == Status::infeasible) return {};
  return words_of(s.miss);
}

std::string words_of(const Miss& miss) {
  const auto& [row, against, by, allowed, tolerance] = miss;
  if (row < 0) return {};
  const std::string which = "row " + std::to_string(row);
  if (against == Miss::Against::outside) return which + " is outside its bounds";
  const auto digits = [](double value) {
    std::ostringstream text;
    text.precision(2);
    text << value;
    return text.str();
  };
  if (!(std::abs(by) < kInf)) return which + " is not finite";
  if (against == Miss::Against::jacobian)
    return which + ": the Jacobian does not fit F, whose change along z differs by " + digits(by) + ", its terms are " +
           digits(allowed);
  if (against == Miss::Against::underflow)
    return which + ": F and its Jacobian are 0 by underflow, not by a solution; on the way to z F decreases to " +
           digits(by) + " without a zero";
  if (against == Miss::Against::cone)
    return "the contact of " + which + " misses Coulomb's law by " + (by == 0 ? "less than any double" : digits(by)) +
           "; " + digits(tolerance) + " of its data is " + digits(allowed);
  static constexpr const char* kPlaces[] = {"inside its bounds", "at its lower bound", "at its upper bound"};
  return which + " misses by " + (by == 0 ? "less than any double" : digits(by)) + ' ' +
         kPlaces[static_cast<int>(against)] + "; " + digits(tolerance) + " of its data is " + digits(allowed);
}

}  // namespace orthant
