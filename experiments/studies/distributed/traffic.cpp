#include "experiments/studies/distributed/traffic.h"

#include <mpi.h>

#include <map>
#include <vector>

namespace orthant {
namespace {

Traffic counted;
std::map<MPI_Request, double> persistent;  // bytes of requests that are started again and again

double bytes_of(int count, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return static_cast<double>(count) * size;
}

void count_message(int count, MPI_Datatype type) {
  ++counted.messages;
  counted.bytes += bytes_of(count, type);
}

void count_collective(MPI_Comm comm) {
  int ranks = 1;
  PMPI_Comm_size(comm, &ranks);
  counted.collectives += ranks > 1 ? 1 : 0;
}

}  // namespace

Traffic traffic() { return counted; }

double time_of_message(int bytes, int repeats) {
  int rank = 0, ranks = 1;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  PMPI_Comm_size(MPI_COMM_WORLD, &ranks);
  if (ranks < 2) return 0;
  std::vector<char> data(static_cast<std::size_t>(bytes));
  PMPI_Barrier(MPI_COMM_WORLD);
  const double begin = PMPI_Wtime();
  for (int k = 0; k < repeats && rank < 2; ++k) {
    if (rank == 0) PMPI_Send(data.data(), bytes, MPI_CHAR, 1, 0, MPI_COMM_WORLD);
    PMPI_Recv(data.data(), bytes, MPI_CHAR, 1 - rank, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (rank == 1) PMPI_Send(data.data(), bytes, MPI_CHAR, 0, 0, MPI_COMM_WORLD);
  }
  return (PMPI_Wtime() - begin) / (2 * repeats);
}

double time_of_reduction(int repeats) {
  double own = 1, all = 0;
  PMPI_Barrier(MPI_COMM_WORLD);
  const double begin = PMPI_Wtime();
  for (int k = 0; k < repeats; ++k) PMPI_Allreduce(&own, &all, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return (PMPI_Wtime() - begin) / repeats;
}

}  // namespace orthant

using orthant::count_collective, orthant::count_message;

extern "C" {

int MPI_Send(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  count_message(count, type);
  return PMPI_Send(data, count, type, to, tag, comm);
}
int MPI_Isend(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) {
  count_message(count, type);
  return PMPI_Isend(data, count, type, to, tag, comm, request);
}
int MPI_Issend(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) {
  count_message(count, type);
  return PMPI_Issend(data, count, type, to, tag, comm, request);
}
int MPI_Send_init(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
                  MPI_Request* request) {
  const int code = PMPI_Send_init(data, count, type, to, tag, comm, request);
  orthant::persistent[*request] = orthant::bytes_of(count, type);
  return code;
}
int MPI_Start(MPI_Request* request) { return MPI_Startall(1, request); }
int MPI_Startall(int count, MPI_Request requests[]) {
  for (int k = 0; k < count; ++k)
    if (const auto found = orthant::persistent.find(requests[k]); found != orthant::persistent.end())
      ++orthant::counted.messages, orthant::counted.bytes += found->second;
  return PMPI_Startall(count, requests);
}
int MPI_Request_free(MPI_Request* request) {
  orthant::persistent.erase(*request);
  return PMPI_Request_free(request);
}
int MPI_Allreduce(const void* from, void* to, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  count_collective(comm);
  return PMPI_Allreduce(from, to, count, type, op, comm);
}
int MPI_Bcast(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm) {
  count_collective(comm);
  return PMPI_Bcast(data, count, type, root, comm);
}
int MPI_Allgather(const void* from, int count, MPI_Datatype type, void* to, int count_to, MPI_Datatype type_to,
                  MPI_Comm comm) {
  count_collective(comm);
  return PMPI_Allgather(from, count, type, to, count_to, type_to, comm);
}
int MPI_Allgatherv(const void* from, int count, MPI_Datatype type, void* to, const int* counts, const int* places,
                   MPI_Datatype type_to, MPI_Comm comm) {
  count_collective(comm);
  return PMPI_Allgatherv(from, count, type, to, counts, places, type_to, comm);
}
int MPI_Scan(const void* from, void* to, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  count_collective(comm);
  return PMPI_Scan(from, to, count, type, op, comm);
}
int MPI_Exscan(const void* from, void* to, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  count_collective(comm);
  return PMPI_Exscan(from, to, count, type, op, comm);
}
int MPI_Reduce(const void* from, void* to, int count, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm) {
  count_collective(comm);
  return PMPI_Reduce(from, to, count, type, op, root, comm);
}

}  // extern "C"
