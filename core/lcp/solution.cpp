#include <orthant/core/lcp/solution.h>

namespace orthant {

std::string_view name(Status status) {
  switch (status) {
    case Status::not_run:
      return "not_run";
    case Status::solved:
      return "solved";
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

}  // namespace orthant
