#include <orthant/solvers/distributed/petsc_objects.h>

#include <signal.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <limits>
#include <vector>

namespace orthant::distributed {
namespace {

std::string
    last_message;  // of the first error handler that was called; PETSc calls one a function, from the inside out
pid_t started_by = 0;
bool started_mpi = false;

PetscErrorCode keep_message(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type,
                            const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL && message != nullptr) last_message = message;
  return code;
}

void end_petsc() {
  if (getpid() != started_by) return;  // a child of fork() ends nothing of its parent
  PetscFinalize();
  if (started_mpi) PMPI_Finalize();
}

/// Signal handlers stay as they are, whatever MPI sets.
class KeptSignals {
 public:
  KeptSignals() {
    for (std::size_t k = 1; k < before_.size(); ++k) sigaction(static_cast<int>(k), nullptr, &before_[k]);
  }
  ~KeptSignals() {
    for (std::size_t k = 1; k < before_.size(); ++k) sigaction(static_cast<int>(k), &before_[k], nullptr);
  }
  KeptSignals(const KeptSignals&) = delete;
  KeptSignals& operator=(const KeptSignals&) = delete;

 private:
  std::array<struct sigaction, 32> before_{};
};

double reduced(MPI_Comm comm, double x, MPI_Op op) {
  double result = x;
  if (MPI_Allreduce(&x, &result, 1, MPI_DOUBLE, op, comm) != MPI_SUCCESS) throw PetscError("MPI_Allreduce failed");
  return result;
}

}  // namespace

void require(PetscErrorCode code) {
  if (code == 0) return;
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  const std::string words = !last_message.empty() ? last_message : text != nullptr ? text : "unknown error";
  last_message.clear();
  throw PetscError("PETSc, error " + std::to_string(static_cast<int>(code)) + ": " + words);
}

void require_everywhere(MPI_Comm comm, const std::string& wrong) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  const int none = std::numeric_limits<int>::max(), own = wrong.empty() ? none : rank;
  int first = none;
  MPI_Allreduce(&own, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == none) return;
  int length = static_cast<int>(wrong.size());
  MPI_Bcast(&length, 1, MPI_INT, first, comm);
  std::vector<char> text(wrong.begin(), wrong.end());
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), length, MPI_CHAR, first, comm);
  throw std::invalid_argument(std::string(text.begin(), text.end()));
}

void start_petsc() {
  PetscBool on = PETSC_FALSE;
  if (PetscInitialized(&on) != 0 || on == PETSC_TRUE) return;
  const KeptSignals signals;
  int mpi = 0;
  MPI_Initialized(&mpi);
  // PMPI: in a process with sequential MUMPS the plain names of some functions belong to its substitute for MPI.
  if (mpi == 0) {
    int provided = 0;
    if (PMPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided) != MPI_SUCCESS)
      throw PetscError("MPI could not be started");
    started_mpi = true;
  }
  PetscOptionsSetValue(nullptr, "-no_signal_handler", "true");
  PetscOptionsSetValue(nullptr, "-skip_petscrc", "true");
  if (PetscInitialize(nullptr, nullptr, nullptr, nullptr) != 0) throw PetscError("PETSc could not be started");
  PetscPushErrorHandler(keep_message, nullptr);
  started_by = getpid();
  std::atexit(end_petsc);
}

double sum_of_all(MPI_Comm comm, double x) { return reduced(comm, x, MPI_SUM); }
double largest_of_all(MPI_Comm comm, double x) { return reduced(comm, x, MPI_MAX); }
double least_of_all(MPI_Comm comm, double x) { return reduced(comm, x, MPI_MIN); }
bool any_of_all(MPI_Comm comm, bool x) { return reduced(comm, x ? 1 : 0, MPI_MAX) > 0; }

}  // namespace orthant::distributed
